// What is being drawn, over the drawing: grid, preview of a link, selection, names of snaps.

import type { Mounted } from "../../mount";
import type { PageData } from "../../page_data";
import { pathOf, put, svg } from "../../svg";
import { roundStep } from "../ranges";
import type { Place, Places } from "./geometry";

export class Overlay {
  private readonly grid = svg("path", { class: "lw-sheet-grid" });
  private readonly group = svg("g", { class: "lw-draft" });
  private readonly traced = svg("g", {}, this.group);
  private readonly marks = svg("g", {}, this.group);
  private readonly line = svg("path", { class: "lw-draft-line" }, this.group);
  private readonly box = svg("rect", { class: "lw-draft-box" }, this.group);
  private readonly end = svg("circle", { class: "lw-draft-end" }, this.group);
  private readonly text = svg("text", { class: "lw-draft-text" }, this.group);

  attach(page: Mounted): void {
    const { element } = page.places.drawing;
    element.prepend(this.grid);
    element.append(this.group);
  }

  detach(): void {
    this.grid.remove();
    this.group.remove();
  }

  /** Lines at round distances over the visible part of the plane; returns their distance. */
  drawGrid(page: Mounted, on: boolean): number {
    const [left, bottom, right, top] = page.places.drawing.view as [number, number, number, number];
    const step = roundStep((right - left) / 16);
    if (!on || !Number.isFinite(step)) {
      put(this.grid, { d: "" });
      return 0;
    }
    const pieces: string[] = [];
    for (let k = Math.ceil(left / step); k * step <= right; k++) pieces.push(`M${k * step} ${-top}V${-bottom}`);
    for (let k = Math.ceil(bottom / step); k * step <= top; k++) pieces.push(`M${left} ${-k * step}H${right}`);
    put(this.grid, { d: pieces.join("") });
    return step;
  }

  /** The paths of points over a motion; null: none. */
  paths(motion: PageData | null): void {
    this.traced.replaceChildren();
    for (const part of motion?.motions[0]?.parts ?? []) {
      if (part.role === "trace" && part.frame === -1) svg("path", { class: "r-trace", d: pathOf(part.points, false) }, this.traced);
    }
  }

  /** A line that is being drawn, with its length and angle. */
  preview(from: Place, to: Place, text: string, pixel: number): void {
    put(this.line, { d: pathOf([...from, ...to], false) });
    this.mark(to, text, pixel);
  }

  /** A circle that is being drawn, with its radius. */
  circle(centre: Place, radius: number, text: string, pixel: number): void {
    this.mark(centre, text, pixel);
    put(this.end, { r: radius });
  }

  /** A place that is being pointed at. */
  mark(at: Place, text: string, pixel: number): void {
    put(this.end, { cx: at[0], cy: -at[1], r: 7 * pixel });
    this.text.textContent = text;
    this.text.style.fontSize = `${13 * pixel}px`;
    put(this.text, { x: at[0] + 12 * pixel, y: -at[1] - 12 * pixel });
  }

  rubber(one: Place, other: Place): void {
    const [x, y] = [Math.min(one[0], other[0]), Math.max(one[1], other[1])];
    put(this.box, { x, y: -y, width: Math.abs(other[0] - one[0]), height: Math.abs(other[1] - one[1]) });
  }

  /** Rings around selected points. */
  select(places: readonly Place[], pixel: number): void {
    this.marks.replaceChildren();
    for (const [x, y] of places) svg("circle", { class: "lw-selected", cx: x, cy: -y, r: 11 * pixel }, this.marks);
  }

  clear(): void {
    put(this.line, { d: "" });
    put(this.end, { r: 0 });
    put(this.box, { width: 0, height: 0 });
    this.text.textContent = "";
  }
}

/** Names of points inside a box. */
export function pointsWithin(points: Places, one: Place, other: Place): string[] {
  const between = (c: number, a: number, b: number): boolean => c >= Math.min(a, b) && c <= Math.max(a, b);
  return Object.entries(points).flatMap(([name, [x, y]]) => (between(x, one[0], other[0]) && between(y, one[1], other[1]) ? [name] : []));
}
