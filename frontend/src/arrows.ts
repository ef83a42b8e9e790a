// Vectors of the loops, and velocities of points, over the drawing.

import type { MotionView } from "./motion";
import type { PageData } from "./page_data";
import { pathOf, svg } from "./svg";
import { toneClass } from "./theme";

const HEAD = 2.4; // length of an arrow head, in pins
const LONGEST = 0.16; // of the largest velocity, of the drawing's longer side

interface Arrow {
  readonly group: SVGGElement;
  readonly shaft: SVGPathElement;
  readonly head: SVGPathElement;
  readonly name: SVGTextElement | null;
}

/** A set of arrows that can be switched on and off. */
export class Arrows {
  private readonly group: SVGGElement;
  private arrows: Arrow[] = [];
  /** A motion that is made arrows for when they are to be seen. */
  private waiting: MotionView | null = null;
  private ends: (row: number) => number[][] = () => [];
  shown = false;

  constructor(
    private data: PageData,
    overlay: SVGGElement,
    private readonly kind: "vectors" | "velocities",
  ) {
    this.group = svg("g", { class: `lw-${kind}` }, overlay);
  }

  renew(data: PageData): void {
    this.data = data;
  }

  show(view: MotionView): void {
    this.waiting = view;
  }

  draw(row: number): void {
    this.group.style.display = this.shown ? "" : "none";
    if (!this.shown) return;
    if (this.waiting) this.make(this.waiting);
    this.ends(row).forEach((ends, k) => this.place(this.arrows[k]!, ends));
  }

  private make(view: MotionView): void {
    this.waiting = null;
    this.group.replaceChildren();
    this.arrows = [];
    if (this.kind === "vectors") this.vectors(view);
    else this.velocities(view);
  }

  private vectors(view: MotionView): void {
    const vectors = view.data.vectors;
    for (const vector of vectors) this.add(toneClass(vector.tone, this.data), short(vector.name));
    const ends = vectors.map(({ start, end, course }) => {
      const [a, b] = [view.points[start], view.points[end]];
      return a && b ? [a.x, a.y, b.x, b.y] : course.map((column) => view.numbers(column));
    });
    this.ends = (row) => ends.map((columns) => columns.map((values) => values[row]!));
  }

  private velocities(view: MotionView): void {
    const points = view.points.filter((point) => point.moving);
    let largest = 0;
    for (const { dx, dy } of points) {
      const speeds = view.order.map((row) => Math.hypot(dx[row]!, dy[row]!)).sort((a, b) => a - b);
      largest = Math.max(largest, speeds[Math.floor(0.98 * (speeds.length - 1))] ?? 0);
    }
    const [left, bottom, right, top] = this.data.view as [number, number, number, number];
    const size = Math.max(right - left, top - bottom);
    const scale = largest > 0 ? (LONGEST * size) / largest : 0;
    for (let k = 0; k < points.length; k++) this.add("lw-velocity", "");
    this.ends = (row) =>
      points.map(({ x, y, dx, dy }) => [
        x[row]!,
        y[row]!,
        x[row]! + scale * dx[row]!,
        y[row]! + scale * dy[row]!,
      ]);
  }

  private add(look: string, name: string): void {
    const group = svg("g", { class: look }, this.group);
    const text = name ? svg("text", { "font-size": 0.85 * this.data.text, "text-anchor": "middle" }, group) : null;
    if (text) text.textContent = name;
    this.arrows.push({
      group,
      shaft: svg("path", { class: "shaft", "stroke-width": 2.4 * this.data.stroke }, group),
      head: svg("path", { class: "head" }, group),
      name: text,
    });
  }

  private place(arrow: Arrow, [x0, y0, x1, y1]: number[]): void {
    const [dx, dy] = [x1! - x0!, y1! - y0!];
    const length = Math.hypot(dx, dy);
    const long = Number.isFinite(length) && length > 0.6 * this.data.pin;
    arrow.group.style.display = long ? "" : "none";
    if (!long) return;
    const head = Math.min(HEAD * this.data.pin, 0.5 * length);
    const [ux, uy] = [dx / length, dy / length];
    const [bx, by] = [x1! - head * ux, y1! - head * uy];
    const half = 0.36 * head;
    arrow.shaft.setAttribute("d", pathOf([x0!, y0!, bx, by], false));
    arrow.head.setAttribute(
      "d",
      pathOf([x1!, y1!, bx - half * uy, by + half * ux, bx + half * uy, by - half * ux], true),
    );
    if (arrow.name) {
      const away = 0.85 * this.data.text;
      arrow.name.setAttribute("x", String(x0! + 0.5 * dx - away * uy));
      arrow.name.setAttribute("y", String(-(y0! + 0.5 * dy + away * ux) + 0.3 * this.data.text));
    }
  }
}

/** The name of a vector without a direction that is a link's name: OA, not OA∠θ_crank. */
function short(name: string): string {
  return name.includes("_") ? name.replace(/∠.*/, "") : name;
}
