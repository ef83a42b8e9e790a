// The toolbar: undo, redo, reload, link, save, and the mark of unsaved changes.

import type { FileState, TaskState } from "../messages";
import { declareKeys, press, type Command } from "../keys";
import { html } from "../svg";
import type { Desk } from "./asking";
import { LinkDialog } from "./link";
import { begin, restored } from "./fields";

export class Bar {
  readonly element = html("div", { class: "lw-bar", role: "toolbar", "aria-label": "File" });
  private readonly file: HTMLElement;
  private readonly back: HTMLButtonElement;
  private readonly undo: HTMLButtonElement;
  private readonly redo: HTMLButtonElement;
  private readonly save: HTMLButtonElement;
  readonly link: LinkDialog;
  private readonly gone = new AbortController();

  constructor(
    private readonly desk: Pick<Desk, "ask">,
    another: () => void,
  ) {
    this.back = this.button("", "", () => this.goBack());
    this.back.hidden = true;
    this.file = html("span", { class: "lw-file" }, this.element);
    this.undo = this.button("↶", "Undo", () => desk.ask({ kind: "undo" }));
    this.redo = this.button("↷", "Redo", () => desk.ask({ kind: "redo" }));
    this.button("New", "New: another mechanism, or a blank sheet", another);
    this.button("Reload", "Reload: read the file again", () => desk.ask({ kind: "reload" }));
    this.link = new LinkDialog(desk);
    this.button("Share", "Share by link", () => this.link.open(this.element.closest(".lw")!));
    this.save = this.button("Save", "Save (Ctrl+S)", () => desk.ask({ kind: "save" }));
    this.save.classList.add("lw-save");
    declareKeys("File", this.commands);
    document.addEventListener("keydown", (event) => this.key(event), { signal: this.gone.signal });
    for (const kind of ["focusin", "change"]) document.addEventListener(kind, (event) => begin(event.target), { signal: this.gone.signal });
    window.addEventListener("beforeunload", (event) => {
      if (this.element.dataset.unsaved === "true" && !this.save.disabled && this.element.isConnected) event.preventDefault();
    });
  }

  show(state: FileState | TaskState): void {
    declareKeys("File", this.commands);
    this.element.dataset.unsaved = String(state.unsaved);
    const name = state.file.split(/[\\/]/).pop();
    this.file.textContent = `${name}${state.unsaved ? " •" : ""}`;
    this.file.title = `${state.file}: ${state.unsaved ? "changes are not saved" : "saved"}`;
    this.file.setAttribute("aria-label", `${state.file}, ${state.unsaved ? "changes are not saved" : "saved"}`);
    label(this.undo, "Undo", "Ctrl+Z", state.undo);
    label(this.redo, "Redo", "Ctrl+Shift+Z", state.redo);
    this.save.disabled = false;
    this.link.renew();
    this.save.classList.toggle("lw-wanted", state.unsaved);
    document.title = `${state.unsaved ? "• " : ""}${state.title} – Linkwork`;
  }

  /** Offer the way back to the task of a design; "" for none. */
  behind(task: string): void {
    this.back.hidden = !task;
    this.back.textContent = "← Task";
    this.back.title = `Back to ${task}`;
    this.back.setAttribute("aria-label", this.back.title);
  }

  private goBack(): void {
    const unsaved = this.element.dataset.unsaved === "true";
    if (unsaved && !confirm("Changes of this mechanism are not saved. Discard them?")) return;
    this.desk.ask({ kind: "return_to_task", discard: unsaved });
  }

  /** Disable all buttons. */
  close(): void {
    this.gone.abort();
    for (const button of this.element.querySelectorAll("button")) button.disabled = true;
  }

  private button(text: string, name: string, act: () => void): HTMLButtonElement {
    const button = html("button", { type: "button", "aria-label": name, title: name }, this.element, text);
    button.addEventListener("click", act);
    return button;
  }

  private readonly commands: readonly Command[] = [
    { keys: ["s"], ctrl: true, does: "Save", act: () => this.desk.ask({ kind: "save" }) },
    { keys: ["z"], ctrl: true, does: "Undo; with Shift redo", act: (event) => this.desk.ask({ kind: event.shiftKey ? "redo" : "undo" }) },
    { keys: ["y"], ctrl: true, does: "Redo", act: () => this.desk.ask({ kind: "redo" }) },
  ];

  private key(event: KeyboardEvent): void {
    if (!this.element.checkVisibility()) return; // the page of another file is open
    const key = event.key.toLowerCase();
    const typing = (event.target as HTMLElement).matches("textarea") || (key === "z" && (event.ctrlKey || event.metaKey) && restored(event.target));
    if (key === "s" || !typing) press(this.commands, event);
  }
}

function label(button: HTMLButtonElement, name: string, keys: string, what: string): void {
  button.disabled = what === "";
  button.title = what ? `${name}: ${what} (${keys})` : `Nothing to ${name.toLowerCase()}`;
  button.setAttribute("aria-label", what ? `${name}: ${what}` : name);
}
