// A chart: quantities over the input, the time or another quantity, in polar form, or a hodograph,
// with a mark at the displayed row.

import type { MotionView } from "./motion";
import { shortNumber } from "./numbers";
import { HODOGRAPH, labelled, panelOf, POLAR, type Panel } from "./panel";
import { choicesOf, joined, POINTS, quantityOf, ratesOf, splitRate, TIME, type Choice, type Rate } from "./quantities";
import { html, put, say, svg } from "./svg";

/** The largest number of curves of a chart. */
const MOST = 4;

const CALLED: Readonly<Record<Rate, string>> = {
  "": "value",
  d1: "1st derivative",
  d2: "2nd derivative",
  velocity: "velocity",
  acceleration: "acceleration",
};

export interface ChartHooks {
  /** Show the row with an index in the order of the motion. */
  readonly goTo: (index: number) => void;
  /** The plotted quantities have changed. */
  readonly changed: () => void;
  /** Remove this chart. */
  readonly removed: () => void;
}

interface Row {
  readonly element: HTMLElement;
  readonly own: HTMLSelectElement;
  readonly rate: HTMLSelectElement;
  readonly value: HTMLElement;
  readonly remove: HTMLButtonElement;
}

export class Chart {
  readonly element: HTMLElement;
  /** The names of the plotted quantities. */
  names: string[];
  over = "";
  private view!: MotionView;
  private past: MotionView | null = null;
  private panel!: Panel;
  private row = -1;
  private more: readonly Choice[] = [];
  private readonly head: HTMLElement;
  private rows: Row[] = [];
  private readonly plot: SVGSVGElement;
  private readonly grid: SVGGElement;
  private readonly frame: SVGSVGElement;
  private readonly limits: SVGGElement;
  private readonly line: SVGLineElement;
  private dots: SVGCircleElement[] = [];
  private readonly abscissa: HTMLSelectElement;
  private readonly add: HTMLButtonElement;
  private readonly sized = new ResizeObserver(() => this.resized());
  private size: readonly [number, number] = [420, 170];

  constructor(
    parent: Element,
    wanted: string,
    private readonly hooks: ChartHooks,
  ) {
    this.names = [wanted];
    this.element = html("figure", { class: "lw-chart" }, parent);
    this.head = html("figcaption", {}, this.element);
    this.plot = svg("svg", { class: "lw-plot", role: "img" }, this.element);
    this.grid = svg("g", {}, this.plot);
    this.frame = svg("svg", {}, this.plot);
    this.limits = svg("g", {}, this.plot);
    this.line = svg("line", { class: "lw-now" }, this.plot);
    const foot = html("div", { class: "lw-chart-foot" }, this.element);
    this.add = button(foot, "+ quantity", "Plot another quantity in this chart", () => this.added());
    button(foot, "×", "Remove this chart", () => hooks.removed()).classList.add("lw-chart-remove");
    const label = html("label", {}, foot, "over ");
    this.abscissa = html("select", { "aria-label": "Abscissa" }, label);
    this.abscissa.addEventListener("change", () => this.turn(this.abscissa.value));
    this.listen();
    this.sized.observe(this.plot);
  }

  /** Show the curves of another motion; `steady` only enlarges the scales, during a drag. */
  show(view: MotionView, past: MotionView | null, steady = false): void {
    this.view = view;
    this.past = past;
    if (!steady || !this.rows.length) this.offer();
    this.redraw(steady);
  }

  /** Offer quantities that the program can compute. */
  offerMore(more: readonly Choice[]): void {
    this.more = more;
    this.offer();
  }

  /** Plot one quantity only. */
  only(name: string): void {
    this.names = [name];
    this.changed();
  }

  draw(row: number): void {
    this.row = row;
    this.dots.forEach((dot, k) => {
      const [x, y] = this.panel.at(k, row);
      const there = Number.isFinite(x) && Number.isFinite(y) && inside(this.panel.box, x, y);
      dot.style.display = there ? "" : "none";
      if (there) put(dot, { cx: x, cy: y });
      if (k === 0 && this.panel.upright && Number.isFinite(x)) put(this.line, { x1: x, x2: x });
      say(this.rows[k]!.value, this.told(k, row));
    });
  }

  destroy(): void {
    this.sized.disconnect();
    this.element.remove();
  }

  private told(k: number, row: number): string {
    const found = quantityOf(this.view, this.names[k]!);
    if (found === null) return "–";
    const unit = found.unit === "deg" ? "°" : found.unit ? ` ${found.unit}` : "";
    return `${shortNumber(found.values[row]!)}${unit}`;
  }

  /** All quantities to choose from. */
  private choices(): Choice[] {
    const own = choicesOf(this.view);
    const known = new Map(own.map((one) => [one.name, one]));
    const orders = new Map(this.more.map((one) => [one.name, one.orders]));
    const others = this.more.filter((one) => !known.has(one.name) && one.name !== this.view.input.name);
    return [...own.map((one) => ({ ...one, orders: orders.get(one.name) })), ...others];
  }

  /** Fill all lists with the quantities of this motion. */
  private offer(): void {
    const choices = this.choices();
    if (!choices.length) return;
    const round = this.over === HODOGRAPH;
    const offered = round ? choices.filter((one) => one.group === POINTS) : choices;
    const listed = JSON.stringify([this.names, this.over, this.view.input.name, this.view.data.speed !== 0, offered]);
    if (listed === this.head.dataset.listed) return;
    this.head.dataset.listed = listed;
    const fits = (name: string): boolean => offered.some((one) => one.name === splitRate(name)[0] || one.name === name);
    const kept = this.names.filter(fits);
    this.names = kept.length ? kept : [this.usual(offered[0]!)];
    this.head.replaceChildren();
    this.rows = this.names.map((name, k) => this.curveRow(name, k, offered));
    this.add.hidden = this.names.length >= MOST;
    this.offerAbscissas(choices);
    if (this.row >= 0 && this.rows.length === this.dots.length) this.draw(this.row);
  }

  /** A quantity with its value, or of a point its first rate. */
  private usual({ name, group }: Choice): string {
    const [first] = ratesOf(this.view, name).filter(Boolean).reverse().filter((rate) => rate === "velocity" || rate === "d1");
    return group === POINTS ? joined(name, first ?? "d1") : name;
  }

  private curveRow(name: string, k: number, choices: readonly Choice[]): Row {
    const element = html("div", { class: `lw-curve-row tone-${k + 1}` }, this.head);
    html("span", { class: "lw-swatch", "aria-hidden": "true" }, element);
    const own = html("select", { "aria-label": "Quantity to plot" }, element);
    const rate = html("select", { class: "lw-rate", "aria-label": "Rate" }, element);
    const value = html("output", { class: "lw-value" }, element);
    const remove = button(element, "×", "Remove this curve", () => this.change(k, null));
    remove.hidden = this.names.length === 1;
    const whole = choices.some((one) => one.name === name);
    const [base, shown]: [string, Rate] = whole ? [name, ""] : splitRate(name);
    fill(own, choices.map((one) => ({ value: one.name, text: labelled(one), group: one.group })), base);
    const orders = choices.find((one) => one.name === base)?.orders;
    const rates = ratesOf(this.view, base, orders);
    fill(rate, rates.map((one) => ({ value: one, text: CALLED[one] })), shown);
    rate.hidden = rates.length < 2;
    own.addEventListener("change", () => {
      const choice = choices.find((one) => one.name === own.value)!;
      const keeps = rates.length && ratesOf(this.view, own.value, choice.orders).includes(shown);
      this.change(k, keeps && shown ? joined(own.value, shown) : this.usual(choice));
    });
    rate.addEventListener("change", () => this.change(k, joined(base, rate.value as Rate)));
    return { element, own, rate, value, remove };
  }

  private offerAbscissas(choices: readonly Choice[]): void {
    const { input, points } = this.view;
    const plain = [{ value: "", text: labelled(input) }];
    if (quantityOf(this.view, TIME)) plain.push({ value: TIME, text: "time [s]" });
    if (input.unit === "deg" || input.unit === "rad") plain.push({ value: POLAR, text: `${input.shown}, polar` });
    if (points.some((point) => point.moving)) plain.push({ value: HODOGRAPH, text: "hodograph" });
    const others = choices.filter((one) => one.group !== POINTS && quantityOf(this.view, one.name));
    const options = [...plain.map((one) => ({ ...one, group: "" })), ...others.map((one) => ({ value: one.name, text: labelled(one), group: one.group }))];
    if (!options.some((one) => one.value === this.over)) this.over = "";
    fill(this.abscissa, options, this.over);
    this.abscissa.previousSibling!.textContent = this.over === HODOGRAPH ? "as " : "over ";
  }

  /** Plot over something else; a hodograph shows points only. */
  private turn(over: string): void {
    const points = this.choices().filter((one) => one.group === POINTS);
    const round = (name: string): boolean => points.some((one) => one.name === splitRate(name)[0]);
    this.over = over;
    if (over === HODOGRAPH && !this.names.every(round)) {
      const traced = this.names.map((name) => points.find((one) => name.startsWith(`${one.name}.`))).find(Boolean);
      this.names = [this.usual(traced ?? points.at(-1)!)];
    }
    this.changed();
  }

  private added(): void {
    const used = new Set(this.names.map((name) => splitRate(name)[0]));
    const choices = this.choices().filter((one) => (this.over === HODOGRAPH) === (one.group === POINTS) || this.over !== HODOGRAPH);
    const next = choices.find((one) => !used.has(one.name) && quantityOf(this.view, this.usual(one))) ?? choices[0];
    if (next) this.names.push(this.usual(next));
    this.changed();
    this.rows.at(-1)?.own.focus();
  }

  private change(k: number, name: string | null): void {
    if (name === null) this.names.splice(k, 1);
    else this.names[k] = name;
    this.changed();
  }

  private changed(): void {
    this.offer();
    this.redraw();
    this.hooks.changed();
  }

  private resized(): void {
    const { clientWidth, clientHeight } = this.plot;
    if (!clientWidth || !clientHeight) return;
    if (this.size[0] === clientWidth && this.size[1] === clientHeight) return;
    this.size = [clientWidth, clientHeight];
    if (this.view) this.redraw();
  }

  private redraw(steady = false): void {
    const [width, height] = this.size;
    const { view, past, names, over } = this;
    if (!this.rows.length) return;
    const before = steady ? (this.panel ?? null) : null;
    const panel = (this.panel = panelOf({ view, past, names, over, width, height, before }));
    put(this.plot, { viewBox: `0 0 ${width} ${height}`, "aria-label": panel.title });
    const [left, top, right, bottom] = panel.box;
    put(this.frame, { x: left - 1, y: top - 2, width: right - left + 2, height: bottom - top + 4, viewBox: `${left - 1} ${top - 2} ${right - left + 2} ${bottom - top + 4}` });
    put(this.line, { y1: top, y2: bottom, visibility: panel.upright ? "visible" : "hidden" });
    if (panel.key !== this.grid.dataset.key) {
      this.grid.dataset.key = panel.key;
      this.grid.replaceChildren();
      panel.grid(this.grid);
    }
    this.curves(panel);
    this.marks(panel);
    if (this.row >= 0) this.draw(Math.min(this.row, view.data.rows - 1));
  }

  private curves(panel: Panel): void {
    this.frame.replaceChildren();
    panel.past.forEach((d, k) => svg("path", { class: `lw-curve lw-past tone-${k + 1}`, d }, this.frame));
    panel.lines.forEach((d, k) => svg("path", { class: `lw-curve tone-${k + 1}`, d }, this.frame));
    while (this.dots.length > panel.lines.length) this.dots.pop()!.remove();
    while (this.dots.length < panel.lines.length) {
      this.dots.push(svg("circle", { class: `lw-dot tone-${this.dots.length + 1}`, r: 4.5 }, this.plot));
    }
  }

  /** Marks at dead points and change points. */
  private marks(panel: Panel): void {
    this.limits.replaceChildren();
    for (const { row, text } of this.view.data.limits) {
      panel.lines.forEach((_, k) => {
        const [cx, cy] = panel.at(k, row);
        if (!Number.isFinite(cx) || !Number.isFinite(cy) || !inside(panel.box, cx, cy)) return;
        const mark = svg("circle", { class: "lw-limit", cx, cy, r: 3.5 }, this.limits);
        svg("title", {}, mark).textContent = text;
      });
    }
  }

  private listen(): void {
    let held = false;
    const move = (event: PointerEvent): void => {
      const matrix = this.plot.getScreenCTM();
      if (matrix === null) return;
      const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
      this.hooks.goTo(this.nearest(place.x, place.y));
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

  /** The index of the nearest row on a curve; over an abscissa, horizontal distance counts more. */
  private nearest(x: number, y: number): number {
    let [best, least] = [0, Infinity];
    const less = this.panel.upright ? 0.35 : 1;
    this.view.order.forEach((row, index) => {
      this.panel.lines.forEach((_, k) => {
        const [px, py] = this.panel.at(k, row);
        const far = Math.hypot(px - x, less * (py - y));
        if (far < least) [best, least] = [index, far];
      });
    });
    return best;
  }
}

function inside([left, top, right, bottom]: Panel["box"], x: number, y: number): boolean {
  return x >= left - 1 && x <= right + 1 && y >= top - 2 && y <= bottom + 2;
}

function button(parent: Element, text: string, title: string, act: () => void): HTMLButtonElement {
  const made = html("button", { type: "button", class: "lw-small", title, "aria-label": title }, parent, text);
  made.addEventListener("click", act);
  return made;
}

interface Option {
  readonly value: string;
  readonly text: string;
  readonly group?: string;
}

/** Fill a list with options in groups. */
function fill(select: HTMLSelectElement, options: readonly Option[], chosen: string): void {
  select.replaceChildren();
  const groups = new Map<string, Element>();
  for (const { value, text, group } of options) {
    let parent: Element = select;
    if (group) {
      parent = groups.get(group) ?? html("optgroup", { label: group }, select);
      groups.set(group, parent);
    }
    html("option", { value }, parent, text);
  }
  select.value = chosen;
}

export function unitText(unit: string): string {
  if (unit === "deg") return "°";
  return unit ? ` ${unit}` : "";
}
