// The Newton panel: steps from a dragged guess, with |F|, unknowns, Jacobian and final status.

import type { FileState, NewtonIterate, NewtonShown } from "../messages";
import type { Mounted } from "../mount";
import { unitText } from "../chart";
import { powerOfTen, shortNumber, trimmed } from "../numbers";
import { html, svg } from "../svg";
import type { Desk } from "./asking";
import { clean, rangeAround } from "./ranges";
import { drawLinks } from "./schematic";

/** The four kinds of failure in words. */
export const TROUBLES: Readonly<Record<string, string>> = {
  SINGULAR_DERIVATIVE: "The Jacobian is singular: the Newton step is undefined or very long.",
  INFLECTION: "The iteration diverges or cycles around an inflection.",
  ANOTHER_ROOT: "The iteration converged to another root than the one nearest to the guess.",
  LOCAL_EXTREMUM: "The iteration is trapped at a local minimum of |F| that is not zero.",
};

export class Newton {
  readonly element = html("div", { class: "lw-newton" });
  private readonly lead: HTMLElement;
  private readonly guesses: HTMLElement;
  private readonly row: HTMLElement;
  private readonly steps: HTMLElement;
  private readonly detail: HTMLElement;
  private readonly outcome: HTMLElement;
  private readonly full: HTMLInputElement;
  private readonly group = svg("g", { class: "lw-iterate" });
  private readonly links = svg("g", {}, this.group);
  private readonly handles = svg("g", {}, this.group);
  private readonly shownGuess = new Map<string, (value: number) => void>();
  private held = "";
  private guess: Record<string, number> = {};
  private at: Record<string, number> = {};
  private found: NewtonShown | null = null;
  private chosen = 0;
  private page: Mounted | null = null;
  private on = false;

  constructor(private readonly desk: Desk) {
    this.lead = html("p", { class: "lw-lead" }, this.element, "Drag the guess in the drawing or move its sliders, and watch the Newton–Raphson steps that start from it at the current input.");
    this.guesses = html("div", {}, this.element);
    const row = (this.row = html("div", { class: "lw-newton-row" }, this.element));
    this.button(row, "Guess of the file", () => this.begin());
    this.button(row, "‹ Step", () => this.step(-1));
    this.button(row, "Step ›", () => this.step(1));
    const label = html("label", { class: "lw-toggle", title: "The plain textbook method, without a limit on the length of a step" }, row);
    this.full = html("input", { type: "checkbox" }, label);
    label.append("Full steps");
    this.full.addEventListener("change", () => this.find());
    this.outcome = html("p", { class: "lw-outcome", role: "status" }, this.element);
    this.steps = html("div", { class: "lw-table lw-steps" }, this.element);
    this.detail = html("div", { class: "lw-table" }, this.element);
  }

  attach(page: Mounted): void {
    this.page = page;
    page.places.drawing.element.append(this.group);
  }

  shown(on: boolean): void {
    this.on = on;
    this.page?.places.drawing.dim(on);
    if (on) this.begin();
    else this.clear();
  }

  private clear(): void {
    this.links.replaceChildren();
    this.handles.replaceChildren();
    this.page?.places.drawing.include("newton", []);
  }

  renew(): void {
    if (this.on) this.begin();
  }

  /** Another row is displayed: use the same guess at its input. */
  moved(): void {
    if (!this.on || this.none) return;
    this.at = this.desk.here();
    this.find();
  }

  /** Choose another step. */
  step(by: number): void {
    this.choose(Math.max(0, this.chosen + by));
  }

  show(found: NewtonShown): void {
    if (!this.on || this.none) return;
    this.found = found;
    this.guess = { ...found.guess };
    for (const [name, value] of Object.entries(found.guess)) this.shownGuess.get(name)?.(value);
    const trouble = TROUBLES[found.trouble] ?? "";
    this.outcome.textContent = [trouble, found.message].filter(Boolean).join(" ");
    this.outcome.dataset.trouble = found.trouble;
    this.outcome.dataset.status = found.status;
    this.list();
    this.choose(Math.min(this.chosen, found.iterates.length - 1));
  }

  /** Whether there is nothing to solve: a draft. */
  private get none(): boolean {
    return this.desk.file().lacks.length > 0;
  }

  /** A sentence in the place of steps. */
  private empty(sentence: string): void {
    this.found = null;
    this.clear();
    for (const box of [this.guesses, this.steps, this.detail]) box.replaceChildren();
    this.outcome.textContent = sentence;
    this.outcome.dataset.trouble = "";
    this.outcome.dataset.status = sentence ? "none" : "";
  }

  private button(parent: Element, text: string, act: () => void): void {
    html("button", { type: "button" }, parent, text).addEventListener("click", act);
  }

  /** Start from the guess of the file at the displayed input. */
  private begin(): void {
    const file = this.desk.file();
    const { none } = this;
    for (const part of [this.lead, this.guesses, this.row]) part.hidden = none;
    if (none) {
      this.empty("Newton\u2019s steps begin once the sketch is a mechanism.");
      return;
    }
    if (this.outcome.dataset.status === "none") this.empty("");
    this.page?.goToInput(this.page.input); // it stands still
    this.at = this.desk.here();
    this.guess = Object.fromEntries(file.unknowns.map((one) => [one.name, one.guess]));
    this.chosen = 0;
    this.sliders(file);
    this.find();
  }

  private sliders(file: FileState): void {
    this.guesses.replaceChildren();
    this.shownGuess.clear();
    const size = Math.max(...file.numbers.map((one) => Math.abs(one.value)), 1e-3);
    for (const unknown of file.unknowns) {
      const line = html("div", { class: "lw-number", "data-guess": unknown.name }, this.guesses);
      html("span", { class: "lw-number-name" }, line, unknown.name);
      const angle = unknown.unit === "deg" || unknown.unit === "rad";
      const range = angle ? rangeAround(unknown.guess, unknown.unit, size) : rangeAround(0, unknown.unit, size);
      const reach = angle ? 2 : 1;
      const middle = angle ? unknown.guess : 0;
      const slider = html(
        "input",
        {
          type: "range",
          min: middle - reach * (middle - range.low),
          max: middle + reach * (range.high - middle),
          step: range.step,
          "aria-label": `Guess of ${unknown.name}`,
        },
        line,
      );
      slider.value = String(unknown.guess);
      const value = html("output", { class: "lw-value" }, line, text(unknown.guess, unknown.unit));
      this.shownGuess.set(unknown.name, (now) => {
        if (document.activeElement !== slider || this.held) slider.value = String(now);
        value.textContent = text(now, unknown.unit);
      });
      slider.addEventListener("input", () => {
        this.guess[unknown.name] = clean(Number(slider.value));
        value.textContent = text(Number(slider.value), unknown.unit);
        this.chosen = 0;
        this.find();
      });
    }
  }

  private find(pull: { pull?: string; x?: number; y?: number } = {}): void {
    this.desk.latest({ kind: "newton_steps", guess: this.guess, at: this.at, full_steps: this.full.checked, ...pull });
  }

  /** List all iterates for selection. */
  private list(): void {
    this.steps.replaceChildren();
    const body = html("table", {}, this.steps);
    const head = html("tr", {}, html("thead", {}, body));
    for (const title of ["k", "|F|", "step"]) html("th", { scope: "col" }, head, title);
    const rows = html("tbody", {}, body);
    this.found!.iterates.forEach((iterate, k) => {
      const line = html("tr", {}, rows);
      const cell = html("th", { scope: "row" }, line);
      const blocks = new Set(this.found!.iterates.map((one) => one.equations.join())).size;
      const name = blocks > 1 ? `${iterate.k} of ${iterate.equations.join(", ")}` : String(iterate.k);
      this.button(cell, iterate.k === 0 ? `guess${blocks > 1 ? ` of ${iterate.equations.join(", ")}` : ""}` : name, () => this.choose(k));
      html("td", {}, line, small(iterate.norm));
      html("td", {}, line, iterate.step === null ? "" : small(iterate.step));
    });
  }

  private choose(k: number): void {
    const iterates = this.found?.iterates ?? [];
    const iterate = iterates[Math.max(0, Math.min(k, iterates.length - 1))];
    if (iterate === undefined) return;
    this.chosen = iterates.indexOf(iterate);
    this.steps.querySelectorAll("tbody tr").forEach((line, number) => {
      line.classList.toggle("lw-chosen", number === this.chosen);
      line.querySelector("button")!.setAttribute("aria-pressed", String(number === this.chosen));
    });
    this.details(iterate);
    this.draw(iterate);
  }

  private details(iterate: NewtonIterate): void {
    this.detail.replaceChildren();
    const names = Object.keys(iterate.unknowns);
    const table = html("table", {}, this.detail);
    html("caption", {}, table, "F and the Jacobian ∂F/∂q at this step");
    const head = html("tr", {}, html("thead", {}, table));
    html("td", {}, head);
    for (const title of ["F", ...names]) html("th", { scope: "col" }, head, title);
    const body = html("tbody", {}, table);
    const values = html("tr", {}, body);
    html("th", { scope: "row" }, values, "q");
    html("td", {}, values);
    for (const name of names) {
      const unit = this.desk.file().unknowns.find((one) => one.name === name)?.unit ?? "";
      html("td", {}, values, text(iterate.unknowns[name] ?? NaN, unit));
    }
    iterate.jacobian.forEach((row, k) => {
      const line = html("tr", {}, body);
      html("th", { scope: "row" }, line, `F${String(k + 1)}`);
      html("td", {}, line, small(iterate.residuals[k]));
      for (const entry of row) html("td", {}, line, small(entry));
    });
  }

  private draw(iterate: NewtonIterate): void {
    if (!this.held) this.page?.places.drawing.include("newton", [...Object.values(iterate.points), ...iterate.open_ends.map((end) => end.end)]);
    const matrix = this.page?.places.drawing.element.getScreenCTM();
    if (!matrix) return;
    const stroke = (this.page!.presentation.on ? 2.4 : 1.2) / matrix.a;
    drawLinks(this.links, this.desk.file().links, iterate.points, { stroke, names: 11 * stroke, ends: iterate.open_ends });
    if (!this.held) this.handles.replaceChildren();
    if (this.held || this.chosen !== 0) return;
    for (const name of this.found!.guessed) {
      const place = iterate.points[name];
      if (place) this.handle(name, this.inSight(place, 14 * stroke), 11 * stroke);
    }
  }

  /** A point, or the nearest point in the view, so that a distant guess can be dragged back. */
  private inSight([x, y]: readonly [number, number], margin: number): [number, number] {
    const { x: left, y: top, width, height } = this.page!.places.drawing.element.viewBox.baseVal;
    const within = (value: number, low: number, high: number): number => Math.min(Math.max(value, low + margin), high - margin);
    return [within(x, left, left + width), -within(-y, top, top + height)];
  }

  /** A handle of the guess: one unknown follows the point. */
  private handle(name: string, [x, y]: readonly [number, number], r: number): void {
    const handle = svg("circle", { class: "lw-sketched", "data-guessed": name, cx: x, cy: -y, r }, this.handles);
    svg("title", {}, handle).textContent = `Drag ${name} to change the guess`;
    handle.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      event.stopPropagation();
      this.held = name;
      handle.setPointerCapture(event.pointerId);
    });
    handle.addEventListener("pointermove", (event) => {
      if (this.held !== name) return;
      const [left, top] = this.page!.places.drawing.placeAt(event);
      this.chosen = 0;
      this.find({ pull: name, x: clean(left), y: clean(top) });
    });
    for (const end of ["pointerup", "pointercancel"] as const) {
      handle.addEventListener(end, () => {
        this.held = "";
        this.choose(this.chosen);
      });
    }
  }
}

function text(value: number, unit: string): string {
  return `${trimmed(shortNumber(value))}${unitText(unit)}`;
}

function small(value: number | null | undefined): string {
  if (value === null || value === undefined) return "–";
  return Math.abs(value) < 1e-3 && value !== 0 ? powerOfTen(value) : shortNumber(value, 4);
}
