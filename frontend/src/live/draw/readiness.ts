// What a draft lacks to be a mechanism: each line with its remedies and a button that goes there.

import type { FileState, Lack } from "../../messages";
import { html } from "../../svg";
import type { Desk } from "../asking";
import type { Chosen } from "./inspector";

export class Readiness {
  readonly element = html("section", { class: "lw-readiness", "aria-label": "What the mechanism lacks", role: "status" });

  constructor(
    private readonly desk: Desk,
    private readonly goTo: (chosen: Chosen) => void,
  ) {}

  show(file: FileState): void {
    this.element.hidden = file.lacks.length === 0;
    this.element.replaceChildren();
    if (this.element.hidden) return;
    const list = html("ul", {}, this.element);
    for (const lack of file.lacks) this.entry(list, lack);
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
