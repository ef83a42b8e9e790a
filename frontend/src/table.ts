// The numbers of the row that is shown: quantities, points, and what is known of the position.

import type { MotionView } from "./motion";
import { powerOfTen, shortNumber } from "./numbers";
import { html } from "./svg";
import { unitText } from "./chart";

type Fill = (row: number) => string;

interface Cell {
  readonly element: HTMLElement;
  readonly fill: Fill;
}

export class RowTable {
  private cells: Cell[] = [];
  private readonly box: HTMLElement;
  private readonly proof: HTMLElement;

  /** `rounding` is the largest length that counts as 0. */
  constructor(
    parent: Element,
    private readonly rounding: number,
  ) {
    this.box = html("div", { class: "lw-table" }, parent);
    this.proof = html("dl", { class: "lw-proof" }, parent);
  }

  show(view: MotionView): void {
    this.cells = [];
    this.box.replaceChildren();
    this.proof.replaceChildren();
    this.quantities(view);
    this.points(view);
    this.evidence(view);
  }

  draw(row: number): void {
    for (const { element, fill } of this.cells) element.textContent = fill(row);
  }

  private quantities(view: MotionView): void {
    const input = view.input;
    const least = (unit: string): number => (unit === "deg" || unit === "rad" ? 1e-9 : this.rounding);
    const body = this.table(["", "value", `by ${input.shown}`]);
    for (const one of view.series) {
      const line = html("tr", {}, body);
      html("th", { scope: "row" }, line, one.shown);
      this.cell(line, (row) => shortNumber(one.values[row]!, 6, least(one.unit)) + unitText(one.unit));
      const first = one.first;
      this.cell(line, (row) => (first ? `${shortNumber(first[row]!, 4, least(one.unit))} ${one.firstUnit}` : ""));
    }
  }

  private points(view: MotionView): void {
    const moving = view.points.filter((point) => point.moving);
    if (!moving.length) return;
    const body = this.table(["point", "x", "y"]);
    for (const point of moving) {
      const line = html("tr", {}, body);
      html("th", { scope: "row" }, line, point.shown);
      this.cell(line, (row) => shortNumber(point.x[row]!, 6, this.rounding));
      this.cell(line, (row) => shortNumber(point.y[row]!, 6, this.rounding));
    }
  }

  private evidence(view: MotionView): void {
    const { evidence } = view.data;
    this.fact("position", (row) => evidence.status_texts[view.status[row]!] ?? "");
    this.fact("residual", (row) => `${powerOfTen(view.residual[row]!)} of the longest link`);
    this.fact("proof", (row) =>
      view.certified[row] === 1
        ? `a true position lies within ${powerOfTen(view.radius[row]!)} of the longest link`
        : (evidence.certification_texts[view.certification[row]!] ?? ""),
    );
    this.fact("Newton steps", (row) => String(view.iterations[row] ?? "–"));
    if (evidence.branch_names.some(Boolean)) {
      this.fact("branch", (row) => evidence.branch_names[view.branch[row]!] || "–");
    }
  }

  private table(heads: readonly string[]): HTMLElement {
    const table = html("table", {}, this.box);
    const line = html("tr", {}, html("thead", {}, table));
    for (const head of heads) html("th", { scope: "col" }, line, head);
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
