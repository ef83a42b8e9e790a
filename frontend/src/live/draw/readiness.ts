// What a draft lacks to be a mechanism: each line with its remedies and a button that goes there; that it lacks nothing any more.

import type { FileState, Lack } from "../../messages";
import { html } from "../../svg";
import type { Desk } from "../asking";
import type { Chosen } from "./selected";

export class Readiness {
  readonly element = html("section", { class: "lw-readiness", "aria-label": "What the mechanism lacks", role: "status" });

  /** Whether the last state of the file lacked something, or has just ceased to. */
  private news = false;

  constructor(
    private readonly desk: Desk,
    private readonly goTo: (chosen: Chosen) => void,
    private readonly move: () => void,
  ) {}

  /** `edited`: the sketch is shown, and not the motion. */
  show(file: FileState, edited: boolean): void {
    const lacks = file.lacks.length > 0;
    this.news = lacks || (edited && this.news);
    this.element.hidden = !this.news;
    this.element.replaceChildren();
    if (this.element.hidden) return;
    const list = html("ul", {}, this.element);
    for (const lack of file.lacks) this.entry(list, lack);
    if (!lacks) this.complete(list);
  }

  /** The motion is shown, or another file. */
  rest(): void {
    if (this.element.querySelector("li:not(.lw-complete)")) return;
    [this.news, this.element.hidden] = [false, true];
  }

  private complete(list: Element): void {
    const line = html("li", { class: "lw-complete" }, list);
    html("span", {}, line, "The mechanism is complete.");
    const button = html("button", { type: "button", class: "lw-remedy" }, line, "Show the motion");
    button.addEventListener("click", this.move);
  }

  private entry(list: Element, lack: Lack): void {
    const line = html("li", {}, list);
    // a thing is the subject of its sentence; a key of the file names the place
    const own = lack.kind ? " " : ": ";
    const text = lack.key ? `${lack.key}${own}${lack.message}` : `${lack.message.slice(0, 1).toUpperCase()}${lack.message.slice(1)}`;
    html("span", {}, line, text);
    for (const { label, edits } of lack.remedies) {
      const button = html("button", { type: "button", class: "lw-remedy" }, line, label);
      button.addEventListener("click", () => this.desk.ask({ kind: "together", edits }));
    }
    const { kind, name } = lack;
    if (kind === "point" || kind === "link" || kind === "part") {
      const show = html("button", { type: "button", class: "lw-show" }, line, "Show");
      show.addEventListener("click", () => this.goTo({ kind, name }));
    }
  }
}
