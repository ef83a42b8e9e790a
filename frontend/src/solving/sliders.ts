// Sliders of the numbers that can be changed in an offline page.

import { unitText } from "../chart";
import { clean, rangeAround } from "../live/ranges";
import type { Mounted } from "../mount";
import { shortNumber, trimmed } from "../numbers";
import type { SliderData, SolverData } from "../page_data";
import { html, say } from "../svg";
import type { SolvedPages } from "./solved_page";

export class Sliders {
  readonly element = html("section", { class: "lw-sliders", "aria-label": "Dimensions" });
  private readonly numbers: number[];
  private readonly shown: ((value: number) => void)[] = [];
  private readonly message: HTMLElement;
  private readonly reset: HTMLButtonElement;
  private asked: { readonly live: boolean } | null = null;

  constructor(
    private readonly data: SolverData,
    private readonly pages: SolvedPages,
    private readonly page: Mounted,
  ) {
    this.numbers = data.sliders.map(({ value }) => value);
    const size = Math.max(1e-3, ...data.sliders.filter(({ unit }) => unit !== "deg").map(({ value }) => Math.abs(value)));
    data.sliders.forEach((slider, k) => this.row(slider, k, size));
    const foot = html("div", { class: "lw-sliders-foot" }, this.element);
    this.reset = html("button", { type: "button", disabled: "" }, foot, "Reset");
    this.reset.addEventListener("click", () => {
      data.sliders.forEach(({ value }, k) => this.change(k, value, false));
    });
    this.message = html("p", { role: "status", class: "lw-ends" }, foot);
    page.places.side.prepend(this.element);
  }

  private row(slider: SliderData, k: number, size: number): void {
    const { name, unit, value } = slider;
    const row = html("div", { class: "lw-slider", "data-number": name }, this.element);
    const label = `${name}${unit ? ` [${unitText(unit).trim()}]` : ""}`;
    html("span", { class: "lw-slider-name" }, row, name);
    const { low, high, step } = rangeAround(value, unit, size);
    const range = html("input", { type: "range", "aria-label": label, min: low, max: high, step }, row);
    const field = html("input", { type: "number", step: "any", "aria-label": `${label}, value`, inputmode: "decimal" }, row);
    html("span", { class: "lw-unit" }, row, unitText(unit).trim());
    const show = (now: number): void => {
      range.value = String(now);
      range.setAttribute("aria-valuetext", `${trimmed(shortNumber(now))}${unitText(unit)}`);
      if (document.activeElement !== field) field.value = trimmed(shortNumber(now)).replace("−", "-");
    };
    this.shown.push(show);
    show(value);
    // the value in the file may lie between the steps
    const moved = (): number => (Math.abs(Number(range.value) - value) < 0.5 * step ? value : clean(Number(range.value)));
    range.addEventListener("input", () => this.change(k, moved(), true));
    range.addEventListener("change", () => this.change(k, moved(), false));
    field.addEventListener("change", () => {
      const typed = field.valueAsNumber;
      if (Number.isFinite(typed)) this.change(k, typed, false);
      else field.value = String(this.numbers[k]);
    });
  }

  /** Another value: the page is solved again before the next frame. */
  private change(k: number, value: number, live: boolean): void {
    this.numbers[k] = value;
    this.shown[k]!(value);
    const waiting = this.asked !== null;
    this.asked = { live };
    if (!waiting) requestAnimationFrame(() => this.solve());
  }

  private solve(): void {
    const live = this.asked?.live ?? false;
    this.asked = null;
    const { page, message } = this.pages.at(this.numbers);
    if (page) this.page.update(page, live);
    this.page.places.stage.parentElement!.classList.toggle("lw-nothing", page === null);
    say(this.message, page ? message : `${message} The drawing and the numbers are those before.`);
    this.reset.disabled = this.data.sliders.every(({ value }, k) => value === this.numbers[k]);
  }
}
