// A slider and a field for every number of the file.

import type { ChangeableNumber, FileState } from "../messages";
import { unitText } from "../chart";
import { shortNumber, trimmed } from "../numbers";
import { html } from "../svg";
import type { Desk } from "./asking";
import { fill } from "./fields";
import { clean, rangeAround, typed } from "./ranges";
import { Units } from "./units";

/** Listed tables of the file with their headings; others are edited in the text. */
const GROUPS: readonly (readonly [string, readonly string[], boolean])[] = [
  ["Dimensions", ["dimensions", "lengths", "angles", "sliders"], true],
  ["Measured in the sketch", ["measured"], false],
  ["Points", ["points"], false],
  ["Guess", ["guess"], false],
];

interface Row {
  readonly element: HTMLElement;
  readonly show: (number: ChangeableNumber, size: number) => void;
}

export class Dimensions {
  readonly element = html("div", { class: "lw-dimensions" });
  private rows = new Map<string, Row>();
  private layout = "";
  /** The groups of the last layout, by their headings. */
  private groups = new Map<string, HTMLDetailsElement>();

  private readonly units: Units;

  constructor(private readonly desk: Desk) {
    this.units = new Units(desk);
  }

  show(file: FileState): void {
    this.units.show(file);
    const size = sizeOf(file);
    const layout = file.numbers.map((one) => `${one.table} ${one.name} ${one.formula !== ""}`).join("\n");
    if (layout !== this.layout) this.build(file);
    this.layout = layout;
    for (const number of file.numbers) this.rows.get(number.name)?.show(number, size);
  }

  private build(file: FileState): void {
    this.rows.clear();
    this.element.replaceChildren(this.units.element);
    const before = this.groups;
    this.groups = new Map();
    let first = true;
    for (const [title, tables, open] of GROUPS) {
      const own = file.numbers.filter((one) => tables.includes(one.table));
      if (!own.length) continue;
      const box = html("details", { class: "lw-group" }, this.element) as HTMLDetailsElement;
      box.open = before.get(title)?.open ?? (open || first); // as the user left it
      this.groups.set(title, box);
      first = false;
      html("summary", {}, box, title);
      for (const number of own) {
        const row = number.formula ? formulaRow(number, this.desk) : sliderRow(number, this.desk);
        this.rows.set(number.name, row);
        box.append(row.element);
      }
    }
    if (first) html("p", { class: "lw-empty" }, this.element, "The file has no named dimensions.");
  }
}

/** Reference size for a length of 0. */
function sizeOf(file: FileState): number {
  const lengths = file.numbers.filter((one) => one.unit === file.length_unit).map((one) => Math.abs(one.value));
  return Math.max(...lengths, 1e-3);
}

function labelled(number: ChangeableNumber): { element: HTMLElement; name: string } {
  const element = html("div", { class: "lw-number", "data-number": number.name });
  const unit = unitText(number.unit).trim();
  html("span", { class: "lw-number-name" }, element, number.name);
  return { element, name: unit ? `${number.name} [${unit}]` : number.name };
}

function field(parent: Element, name: string, desk: Desk, of: string): HTMLInputElement {
  const input = html("input", { type: "text", class: "lw-field", "aria-label": name, autocomplete: "off", spellcheck: "false" }, parent);
  input.addEventListener("change", () => {
    if (input.value.trim()) {
      desk.ask({ kind: "set_number", name: of, value: typed(input.value), any_formula: true });
      return;
    }
    const now = desk.file().numbers.find((one) => one.name === of); // nothing was typed
    if (now) input.value = now.formula || trimmed(shortNumber(now.value));
  });
  return input;
}

function sliderRow(number: ChangeableNumber, desk: Desk): Row {
  const { element, name } = labelled(number);
  const slider = html("input", { type: "range", "aria-label": name }, element);
  const input = field(element, `${name}, value`, desk, number.name);
  html("span", { class: "lw-unit" }, element, unitText(number.unit).trim());
  slider.addEventListener("input", () => {
    const value = clean(Number(slider.value));
    input.value = trimmed(shortNumber(value));
    desk.latest({ kind: "set_number", name: number.name, value, live: true });
  });
  slider.addEventListener("change", () => {
    desk.ask({ kind: "set_number", name: number.name, value: clean(Number(slider.value)) });
  });
  return {
    element,
    show: (now, size) => {
      const range = rangeAround(now.value, now.unit, size);
      const outside = now.value < Number(slider.min) || now.value > Number(slider.max);
      // The range stays while the value is well inside, so that the slider can be set back.
      if (slider.dataset.known === undefined || outside || off(slider, now.value)) {
        slider.min = String(range.low);
        slider.max = String(range.high);
        slider.step = String(range.step);
        slider.dataset.known = "";
      }
      slider.value = String(now.value);
      slider.setAttribute("aria-valuetext", `${trimmed(shortNumber(now.value))}${unitText(now.unit)}`);
      fill(input, trimmed(shortNumber(now.value)));
      input.title = String(now.value);
    },
  };
}

/** Whether a value is between the steps of a slider. */
function off(slider: HTMLInputElement, value: number): boolean {
  const steps = (value - Number(slider.min)) / Number(slider.step);
  return Math.abs(steps - Math.round(steps)) > 1e-6;
}

function formulaRow(number: ChangeableNumber, desk: Desk): Row {
  const { element, name } = labelled(number);
  element.classList.add("lw-formula");
  const input = field(element, `${name}, formula`, desk, number.name);
  const value = html("span", { class: "lw-unit" }, element);
  return {
    element,
    show: (now) => {
      fill(input, now.formula);
      value.textContent = `= ${trimmed(shortNumber(now.value))}${unitText(now.unit)}`;
    },
  };
}
