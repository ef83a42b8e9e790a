// The units of the file: another one is chosen, and it is asked whether numbers are converted.

import type { FileState } from "../messages";
import { html } from "../svg";
import type { Desk } from "./asking";

const LENGTHS = ["mm", "cm", "m", "km", "µm", "in", "ft"];
const ANGLES = ["deg", "rad"];

export class Units {
  readonly element = html("div", { class: "lw-units" });
  private readonly length = this.choice("Lengths in", "length");
  private readonly angle = this.choice("Angles in", "angle");
  private readonly question = html("div", { class: "lw-units-question", role: "group", hidden: "" }, this.element);

  constructor(private readonly desk: Desk) {}

  show(file: FileState): void {
    fillWith(this.length, LENGTHS, file.length_unit);
    fillWith(this.angle, ANGLES, file.angle_unit);
    this.question.hidden = true;
  }

  private choice(label: string, kind: "length" | "angle"): HTMLSelectElement {
    const select = html("select", {}, html("label", {}, this.element, label));
    select.addEventListener("change", () => this.ask(kind, select.value));
    return select;
  }

  private ask(kind: "length" | "angle", unit: string): void {
    const file = this.desk.file();
    const own = kind === "length" ? file.length_unit : file.angle_unit;
    this.question.replaceChildren();
    this.question.hidden = unit === own;
    html("p", {}, this.question, `From ${own || "no unit"} to ${unit}:`);
    const answers: [string, string, () => void][] = [
      ["Convert", "All numbers are converted: the mechanism stays as large as it is.", () => this.desk.ask({ kind: "change_units", [kind]: unit, convert: true })],
      ["Relabel", "All numbers stay, under another unit.", () => this.desk.ask({ kind: "change_units", [kind]: unit, convert: false })],
      ["Cancel", "The unit stays.", () => undefined],
    ];
    for (const [label, title, act] of answers) {
      const button = html("button", { type: "button", title }, this.question, label);
      button.addEventListener("click", () => {
        this.show(this.desk.file()); // a refused change leaves the unit
        act();
      });
    }
    this.question.querySelector("button")?.focus();
  }
}

function fillWith(select: HTMLSelectElement, units: readonly string[], own: string): void {
  select.replaceChildren();
  for (const unit of units.includes(own) ? units : [own, ...units]) html("option", { value: unit }, select, unit || "no unit");
  select.value = own;
}
