// The charts of a page: quantities chosen by the visitor, and the design before in pale lines.

import { Chart } from "./chart";
import type { MotionView } from "./motion";
import { quantityOf, type Choice } from "./quantities";
import { html } from "./svg";

/** The largest number of charts. */
const MOST = 6;

const BY_TIME = /\.(velocity|acceleration|jerk|snap)$/;

export class Charts {
  readonly element: HTMLElement;
  private readonly list: Chart[] = [];
  private readonly add: HTMLButtonElement;
  private view: MotionView | null = null;
  private past: MotionView | null = null;
  private more: readonly Choice[] = [];
  private row = -1;
  private asked = "[]";
  /** Called with plotted names that the data does not contain. */
  ask: (names: readonly string[]) => void = () => undefined;

  constructor(
    parent: Element,
    names: readonly string[],
    private readonly goTo: (index: number) => void,
  ) {
    this.element = html("div", { class: "lw-charts", hidden: "" }, parent);
    this.add = html("button", { type: "button", class: "lw-small lw-chart-add" }, this.element, "+ chart");
    this.add.addEventListener("click", () => {
      const [first] = this.list;
      this.put(first?.names[0] ?? names[0] ?? "");
      this.changed();
    });
    for (const name of names) this.put(name);
  }

  get count(): number {
    return this.list.length;
  }

  /** Show another motion, in one chart if it has its `turn`, else in all. */
  show(view: MotionView, past: MotionView | null, steady = false, turn: number | null = null): void {
    this.view = view;
    this.past = past;
    this.element.hidden = false;
    for (const chart of this.having(turn)) chart.show(view, past, steady);
    if (!steady) this.changed();
  }

  draw(row: number, turn: number | null = null): void {
    this.row = row;
    for (const chart of this.having(turn)) chart.draw(row);
  }

  private having(turn: number | null): Chart[] {
    return turn === null ? this.list : this.list.slice(turn, turn + 1);
  }

  /** Offer quantities that the program can compute. */
  offer(more: readonly Choice[]): void {
    this.more = more;
    for (const chart of this.list) chart.offerMore(more);
  }

  /** Plot a quantity in place of the last chart, or in another one, unless it is plotted. */
  plot(name: string): void {
    if (this.list.some((chart) => chart.names.includes(name))) return;
    const last = this.list.at(-1);
    if (last && this.list.length > 1) last.only(name);
    else this.put(name);
    this.changed();
  }

  /** The displayed motion is another one, for which nothing was asked yet. */
  askAgain(): void {
    this.asked = "[]";
    this.changed();
  }

  destroy(): void {
    for (const chart of this.list) chart.destroy();
  }

  private put(name: string): void {
    const chart: Chart = new Chart(this.element, name, {
      goTo: this.goTo,
      changed: () => this.changed(),
      removed: () => {
        this.list.splice(this.list.indexOf(chart), 1);
        chart.destroy();
        this.changed();
      },
    });
    this.list.push(chart);
    this.element.append(this.add);
    if (this.view) {
      chart.show(this.view, this.past);
      chart.offerMore(this.more);
      chart.draw(this.row);
    }
  }

  private changed(): void {
    this.add.hidden = this.list.length >= MOST;
    this.element.dataset.charts = String(this.list.length);
    const { view } = this;
    if (!view) return;
    const plotted = this.list.flatMap((chart) => chart.names);
    const given = new Set(view.data.columns.filter((column) => column.group !== "asked").map((column) => column.name));
    const missing = [...new Set(plotted)].filter((name) => {
      // without a speed there are no rates by time
      if (!view.data.speed && BY_TIME.test(name)) return false;
      const column = view.series.find((one) => one.name === name);
      return column ? !given.has(name) : quantityOf(view, name) === null;
    });
    const wanted = JSON.stringify(missing);
    if (wanted === this.asked) return;
    this.asked = wanted;
    this.ask(missing);
  }
}
