// A quantity over the input, with a mark at the displayed row. A circuit that reverses at
// dead points is one closed curve.

import type { MotionView, Series } from "./motion";
import { degreeTicks, shortNumber, ticks, trimmed } from "./numbers";
import { html, put, say, svg } from "./svg";

const WIDTH = 420;
const HEIGHT = 190;
const LEFT = 52;
const RIGHT = 20;
const ABOVE = 12;
const BELOW = 30;

interface Scale {
  readonly low: number;
  readonly high: number;
  readonly at: (value: number) => number;
}

export class Chart {
  readonly element: HTMLElement;
  private readonly select: HTMLSelectElement;
  private readonly plot: SVGSVGElement;
  private view!: MotionView;
  private chosen: string;
  private x!: Scale;
  private y!: Scale;
  private readonly grid: SVGGElement;
  private readonly path: SVGPathElement;
  private readonly limits: SVGGElement;
  private readonly dot: SVGCircleElement;
  private readonly line: SVGLineElement;
  private value!: HTMLElement;
  private series!: Series;

  constructor(
    parent: Element,
    wanted: string,
    private readonly goTo: (index: number) => void,
  ) {
    this.chosen = wanted;
    this.element = html("figure", { class: "lw-chart" }, parent);
    const head = html("figcaption", {}, this.element);
    this.select = html("select", { "aria-label": "Quantity to plot" }, head);
    this.value = html("output", { class: "lw-value" }, head);
    this.plot = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" }, this.element);
    this.grid = svg("g", {}, this.plot);
    this.path = svg("path", { class: "lw-curve" }, this.plot);
    this.limits = svg("g", {}, this.plot);
    this.line = svg("line", { class: "lw-now", y1: ABOVE, y2: HEIGHT - BELOW }, this.plot);
    this.dot = svg("circle", { class: "lw-dot", r: 4.5 }, this.plot);
    this.select.addEventListener("change", () => {
      this.chosen = this.select.value;
      this.redraw();
    });
    this.listen();
  }

  /** Show the curve of another motion; `steady` only enlarges the scales, during a drag. */
  show(view: MotionView, steady = false): void {
    this.view = view;
    const names = view.series.slice(1);
    const listed = names.map(labelled).join("\n");
    if (listed !== this.select.dataset.listed) {
      this.select.dataset.listed = listed;
      this.select.replaceChildren();
      for (const one of names) html("option", { value: one.name }, this.select, labelled(one));
      if (!names.some((one) => one.name === this.chosen)) this.chosen = names[0]?.name ?? "";
      this.select.value = this.chosen;
    }
    this.redraw(steady);
  }

  draw(row: number): void {
    const value = this.series.values[row]!;
    const input = this.view.input.values[row]!;
    if (!Number.isFinite(value)) return; // a row that was not found before, on the way of a drag
    const x = this.x.at(input);
    put(this.dot, { cx: x, cy: this.y.at(value) });
    put(this.line, { x1: x, x2: x });
    say(this.value, `${shortNumber(value)}${unitText(this.series.unit)}`);
  }

  private redraw(steady = false): void {
    const { input, order } = this.view;
    this.series = this.view.series.find((one) => one.name === this.chosen) ?? input;
    const values = order.map((row) => this.series.values[row]!);
    if (steady) values.push(this.y.low, this.y.high);
    this.x = scale(Array.from(input.values), LEFT, WIDTH - RIGHT);
    this.y = scale(values, HEIGHT - BELOW, ABOVE, steady ? 0 : 0.06);
    const name = `${labelled(this.series)} over ${labelled(input)}`;
    const axes = [name, this.x.low, this.x.high, this.y.low, this.y.high].join(" ");
    if (axes !== this.grid.dataset.axes) {
      this.grid.dataset.axes = axes;
      this.grid.replaceChildren();
      put(this.plot, { "aria-label": name });
      this.axes(input);
    }
    put(this.path, { d: this.curve() });
    this.limits.replaceChildren();
    for (const limit of this.view.data.limits) this.limit(limit.row, limit.text);
  }

  private axes(input: Series): void {
    const across = (input.unit === "deg" ? degreeTicks : ticks)(this.x.low, this.x.high, 6);
    const digits = (value: number): string => trimmed(shortNumber(value, 5));
    for (const value of across) {
      const x = this.x.at(value);
      svg("line", { class: "lw-grid", x1: x, x2: x, y1: ABOVE, y2: HEIGHT - BELOW }, this.grid);
      svg("text", { x, y: HEIGHT - BELOW + 14, "text-anchor": "middle" }, this.grid).textContent = digits(value);
    }
    const up = (this.series.unit === "deg" ? degreeTicks : ticks)(this.y.low, this.y.high, 4);
    for (const value of up) {
      const y = this.y.at(value);
      svg("line", { class: "lw-grid", x1: LEFT, x2: WIDTH - RIGHT, y1: y, y2: y }, this.grid);
      svg("text", { x: LEFT - 6, y: y + 3.5, "text-anchor": "end" }, this.grid).textContent = digits(value);
    }
    const where = { x: WIDTH - RIGHT, y: HEIGHT - 3, "text-anchor": "end", class: "lw-axis" };
    svg("text", where, this.grid).textContent = labelled(input);
  }

  /** The curve in the order of the motion, broken where the input begins a new turn. */
  private curve(): string {
    const { input, order, data } = this.view;
    const wide = (this.x.high - this.x.low) / 2;
    const pieces: string[] = [];
    const usual = this.usualStep(order, input);
    let before = Number.NaN;
    let last = 0;
    const to = (letter: string, value: number, row: number): number =>
      pieces.push(`${letter}${this.x.at(value).toFixed(2)} ${this.y.at(this.series.values[row]!).toFixed(2)}`);
    for (const row of data.closed ? [...order, order[0]!] : order) {
      const value = input.values[row]!;
      const far = Math.abs(value - before);
      const onward = far <= wide && !(far > 1.5 * usual && this.isGap(last, row));
      if (far > wide) {
        // The curve continues at the other side, one turn further: end it at the edge.
        const turned = before + Math.sign(before - value) * this.step(order, input);
        const end = this.rowAt(turned, this.series.values[last]!);
        if (end !== null) to("L", turned, end);
      }
      to(onward ? "L" : "M", value, row);
      before = value;
      last = row;
    }
    return pieces.join("");
  }

  /** The table row at an input value with the value nearest to another; null without one. */
  private rowAt(value: number, beside: number): number | null {
    let best: number | null = null;
    let least = 0.2 * (this.y.high - this.y.low);
    this.view.input.values.forEach((one, row) => {
      if (!(Math.abs(one - value) <= 1e-6 * (this.x.high - this.x.low))) return;
      const far = Math.abs(this.series.values[row]! - beside);
      if (far < least) [best, least] = [row, far];
    });
    return best;
  }

  /** Whether there are rows without a position between two table rows. */
  private isGap(one: number, other: number): boolean {
    return !this.view.found.slice(Math.min(one, other), Math.max(one, other)).every(Boolean);
  }

  private usualStep(order: readonly number[], input: Series): number {
    const steps = order.slice(1).map((row, k) => Math.abs(input.values[row]! - input.values[order[k]!]!));
    return steps.sort((a, b) => a - b)[Math.floor(steps.length / 2)] ?? 0;
  }

  /** The step of the first input values. */
  private step(order: readonly number[], input: Series): number {
    return Math.abs(input.values[order[1] ?? 0]! - input.values[order[0]!]!);
  }

  private limit(row: number, text: string): void {
    const mark = svg(
      "circle",
      {
        class: "lw-limit",
        cx: this.x.at(this.view.input.values[row]!),
        cy: this.y.at(this.series.values[row]!),
        r: 3.5,
      },
      this.limits,
    );
    svg("title", {}, mark).textContent = text;
  }

  private listen(): void {
    let held = false;
    const move = (event: PointerEvent): void => {
      const matrix = this.plot.getScreenCTM();
      if (matrix === null) return;
      const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
      this.goTo(this.nearest(place.x, place.y));
    };
    this.plot.addEventListener("pointerdown", (event) => {
      held = true;
      this.plot.setPointerCapture(event.pointerId);
      move(event);
    });
    this.plot.addEventListener("pointermove", (event) => held && move(event));
    for (const end of ["pointerup", "pointercancel"] as const) {
      this.plot.addEventListener(end, () => (held = false));
    }
  }

  /** The index of the nearest row on the curve; horizontal distance counts more. */
  private nearest(x: number, y: number): number {
    const { input, order } = this.view;
    let [best, least] = [0, Infinity];
    order.forEach((row, k) => {
      const far = Math.hypot(this.x.at(input.values[row]!) - x, 0.35 * (this.y.at(this.series.values[row]!) - y));
      if (far < least) [best, least] = [k, far];
    });
    return best;
  }
}

function scale(values: readonly number[], from: number, to: number, air = 0): Scale {
  const known = values.filter(Number.isFinite);
  let low = Math.min(...known);
  let high = Math.max(...known);
  const least = 1e-6 * Math.max(1, Math.abs(low), Math.abs(high));
  if (!(high - low > least)) [low, high] = [low - 0.5, high + 0.5];
  const room = air * (high - low);
  [low, high] = [low - room, high + room];
  return { low, high, at: (value) => from + ((value - low) / (high - low)) * (to - from) };
}

export function unitText(unit: string): string {
  if (unit === "deg") return "°";
  return unit ? ` ${unit}` : "";
}

function labelled(series: Series): string {
  return series.unit ? `${series.shown} [${series.unit}]` : series.shown;
}
