// The tool that measures: two clicks a distance, three an angle; nothing is written into the file.

import type { Mounted } from "../../mount";
import { html, pathOf, put, svg } from "../../svg";
import type { Desk } from "../asking";
import { pointAt } from "./geometry";
import { told, outputOf, type Mark } from "./measuring";
import { freeName } from "./names";

/** Attraction of points [px]: of a mouse, of a finger. */
const REACH = { mouse: 12, touch: 24 };

export class Measure {
  private readonly group = svg("g", { class: "lw-measure" });
  private readonly line = svg("path", { class: "lw-measure-line" }, this.group);
  private readonly ends = svg("g", {}, this.group);
  private readonly panel = html("div", { class: "lw-measured", role: "status", hidden: "" });
  private readonly text = html("span", {}, this.panel);
  private readonly output = html("button", { type: "button" }, this.panel, "Add as output");
  private marks: readonly Mark[] = [];
  private page: Mounted | null = null;
  on = false;

  constructor(
    private readonly desk: Desk,
    private readonly toggled: () => void,
  ) {
    this.output.addEventListener("click", () => this.add());
    const close = html("button", { type: "button", class: "lw-close", "aria-label": "End measuring" }, this.panel, "×");
    close.addEventListener("click", () => this.set(false));
  }

  attach(page: Mounted): void {
    this.page = page;
    page.places.drawing.element.append(this.group);
    page.places.canvas.append(this.panel);
    this.set(this.on);
  }

  set(on: boolean): void {
    this.on = on;
    if (!on) this.marks = [];
    this.panel.hidden = !on;
    this.page?.places.canvas.classList.toggle("lw-measuring", on);
    this.toggled();
    this.draw();
  }

  /** A click on the drawing. */
  click(event: PointerEvent): void {
    const { drawing } = this.page!.places;
    const at = drawing.placeAt(event);
    const reach = (event.pointerType === "mouse" ? REACH.mouse : REACH.touch) * drawing.pixel;
    const point = pointAt({ points: this.page!.points, links: [] }, at, reach);
    const before = this.marks.length > 2 ? [] : this.marks;
    if (point && before.some((mark) => mark.point === point)) return;
    this.marks = [...before, point ? { at: this.page!.points[point]!, point } : { at }];
    this.draw();
  }

  /** Measure again: the mechanism has moved, or the view. */
  draw(): void {
    if (this.page === null) return;
    const file = this.desk.file();
    const { points, places } = this.page;
    // a point that is gone is forgotten
    const marks = this.marks.flatMap((mark): Mark[] => (mark.point === undefined ? [mark] : points[mark.point] ? [{ ...mark, at: points[mark.point]! }] : []));
    this.marks = marks;
    put(this.line, { d: marks.length ? pathOf(marks.flatMap(({ at }) => [...at]), false) : "" });
    this.ends.replaceChildren();
    for (const { at: [x, y] } of marks) svg("circle", { cx: x, cy: -y, r: 5 * places.drawing.pixel }, this.ends);
    const clicks = ["Click a first point.", "Click a second point."][marks.length];
    this.text.textContent = clicks ?? told(marks, file.length_unit, file.angle_unit);
    const possible = outputOf(marks);
    this.output.hidden = marks.length < 2;
    this.output.disabled = possible === null || file.form !== "points-and-links";
    this.output.title = this.output.disabled ? "Not possible: outputs are made of points of the mechanism" : "A named formula in the file, to plot and export";
  }

  private add(): void {
    const found = outputOf(this.marks);
    if (found === null) return;
    const file = this.desk.file();
    const taken = [...Object.keys(file.points), ...file.links.map(({ name }) => name), ...file.parts, ...file.numbers.map(({ name }) => name), ...file.outputs];
    this.desk.ask({ kind: "add_output", name: freeName(taken, found.base), formula: found.formula });
  }
}
