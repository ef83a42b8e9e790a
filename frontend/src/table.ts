// The numbers of the displayed row: quantities, points and evidence.

import type { MotionView } from "./motion";
import { LEAST_ANGLE, powerOfTen, shortNumber } from "./numbers";
import { html, say } from "./svg";
import { unitText } from "./chart";

type Fill = (row: number) => string;

interface Cell {
  readonly element: HTMLElement;
  readonly fill: Fill;
}

export class RowTable {
  private cells: Cell[] = [];
  private view!: MotionView;
  private made = "";
  private readonly box: HTMLElement;
  private readonly proof: HTMLElement;

  /** `rounding` is the largest length that counts as 0. */
  constructor(
    parent: Element,
    private readonly rounding: number,
  ) {
    this.box = html("div", { class: "lw-table", tabindex: 0, role: "group", "aria-label": "Numbers" }, parent);
    this.proof = html("dl", { class: "lw-proof" }, parent);
  }

  /** Show the numbers of another motion; cells with equal names are reused. */
  show(view: MotionView): void {
    this.view = view;
    const wanted = madeOf(view);
    if (wanted === this.made) return;
    this.made = wanted;
    this.cells = [];
    this.box.replaceChildren();
    this.proof.replaceChildren();
    this.quantities(view);
    this.points(view);
    this.evidence(view);
  }

  draw(row: number): void {
    for (const { element, fill } of this.cells) say(element, fill(row));
  }

  private quantities(view: MotionView): void {
    const input = view.input;
    const least = (unit: string): number => (unit === "deg" || unit === "rad" ? LEAST_ANGLE : this.rounding);
    const body = this.table(["", "value", `w.r.t. ${input.shown}`]);
    view.series.forEach(({ shown, unit, firstUnit }, k) => {
      const line = html("tr", {}, body);
      html("th", { scope: "row" }, line, shown);
      this.cell(line, (row) => withUnit(this.view.series[k]!.values[row]!, 6, least(unit), unitText(unit)));
      this.cell(line, (row) => {
        const first = this.view.series[k]!.first;
        return first ? withUnit(first[row]!, 4, least(unit), ` ${firstUnit}`) : "";
      });
    });
  }

  private points(view: MotionView): void {
    if (!view.points.some((point) => point.moving)) return;
    const body = this.table(["point", "x", "y"]);
    view.points.forEach(({ shown, moving }, k) => {
      if (!moving) return;
      const line = html("tr", {}, body);
      html("th", { scope: "row" }, line, shown);
      this.cell(line, (row) => shortNumber(this.view.points[k]!.x[row]!, 6, this.rounding));
      this.cell(line, (row) => shortNumber(this.view.points[k]!.y[row]!, 6, this.rounding));
    });
  }

  private evidence(view: MotionView): void {
    const texts = (): MotionView["data"]["evidence"] => this.view.data.evidence;
    this.fact("position", (row) => texts().status_texts[this.view.status[row]!] ?? "");
    this.fact("residual", (row) => `${powerOfTen(this.view.residual[row]!)} of the longest link`);
    this.fact("proof", (row) =>
      this.view.certified[row] === 1 && Number.isFinite(this.view.radius[row])
        ? `a true position lies within ${powerOfTen(this.view.radius[row]!)} of the longest link`
        : (texts().certification_texts[this.view.certification[row]!] ?? ""),
    );
    this.fact("Newton steps", (row) => String(this.view.iterations[row] ?? "–"));
    if (hasBranches(view)) {
      this.fact("branch", (row) => texts().branch_names[this.view.branch[row]!] || "–");
    }
  }

  private table(heads: readonly string[]): HTMLElement {
    const table = html("table", {}, this.box);
    const line = html("tr", {}, html("thead", {}, table));
    for (const head of heads) html(head ? "th" : "td", head ? { scope: "col" } : {}, line, head);
    return html("tbody", {}, table);
  }

  private cell(line: HTMLElement, fill: Fill): void {
    this.cells.push({ element: html("td", {}, line), fill });
  }

  private fact(name: string, fill: Fill): void {
    html("dt", {}, this.proof, name);
    this.cells.push({ element: html("dd", { "data-fact": name }, this.proof), fill });
  }
}

/** What has no value has no unit either. */
function withUnit(value: number, digits: number, rounding: number, unit: string): string {
  return shortNumber(value, digits, rounding) + (Number.isFinite(value) ? unit : "");
}

function hasBranches(view: MotionView): boolean {
  return view.data.evidence.branch_names.some(Boolean);
}

/** A key of the cells of a motion. */
function madeOf(view: MotionView): string {
  const rows = view.series.map(({ shown, unit, firstUnit }) => `${shown} ${unit} ${firstUnit}`);
  const points = view.points.map(({ shown, moving }) => `${shown} ${moving}`);
  return [...rows, "points", ...points, hasBranches(view)].join("\n");
}
