// Arrows over the drawing: vectors of the loops, velocities and accelerations of points, forces.

import { forcesOf, forceUnit } from "./forces";
import type { MotionView, Point } from "./motion";
import { roundUp, shortNumber, trimmed } from "./numbers";
import type { PageData } from "./page_data";
import { pathOf, svg } from "./svg";
import { toneClass } from "./theme";

const HEAD = 2.4; // length of an arrow head, in pins
const LONGEST = 0.16; // of the usual largest, of the drawing's longer side
const SHORTEST = 1.5; // pins: a shorter arrow would be hidden by its pin
const LEAST = 5.5; // pins: a smaller force is drawn so long, dashed
const NOTHING = 1e-9; // of the usual largest: rounding, not drawn
const USUAL = 0.98; // of the rows are not faster: rates grow without bound beside dead points

interface Arrow {
  readonly group: SVGGElement;
  readonly shaft: SVGPathElement;
  readonly head: SVGPathElement;
  readonly name: SVGTextElement | null;
}

/** Tails and tips of arrows in a row: x, y, x, y each. */
type Ends = (row: number) => number[][];

export type ArrowKind = "vectors" | "velocities" | "accelerations" | "forces";

/** A set of arrows that can be switched on and off. */
export class Arrows {
  private readonly group: SVGGElement;
  private arrows: Arrow[] = [];
  /** Set a motion; its arrows are created when they are shown. */
  private waiting: MotionView | null = null;
  private ends: Ends = () => [];
  /** The scale of the arrows; "" if not needed. */
  legend = "";
  shown = false;
  /** A force per unit of drawn length, and the least that is drawn. */
  private each = 0;
  private nothing = 0;
  /** The extent of arrows over the whole motion: two corners; empty for loop vectors. */
  reach: (readonly [number, number])[] = [];

  constructor(
    private data: PageData,
    overlay: SVGGElement,
    readonly kind: ArrowKind,
    private readonly names: Names,
  ) {
    this.group = svg("g", { class: `lw-${kind}` }, overlay);
  }

  /** Whether there are arrows. */
  get any(): boolean {
    if (this.kind === "vectors") return this.data.motions.some((motion) => motion.vectors.length > 0);
    return this.kind !== "forces" || this.data.forces.length > 0 || this.data.motions.some((motion) => motion.reactions.length > 0);
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
    const made = {
      vectors: () => this.vectors(view),
      velocities: () => this.rates(view, 1),
      accelerations: () => this.rates(view, 2),
      forces: () => this.forces(view),
    };
    this.ends = made[this.kind]();
    this.reach = this.kind === "vectors" ? [] : corners(view.order.flatMap((row) => this.ends(row)));
  }

  private vectors(view: MotionView): Ends {
    const vectors = view.data.vectors;
    for (const vector of vectors) this.add(toneClass(vector.tone, this.data), short(vector.name));
    const ends = vectors.map(({ start, end, course }) => {
      const [a, b] = [view.points[start], view.points[end]];
      return a && b ? [a.x, a.y, b.x, b.y] : course.map((column) => view.numbers(column));
    });
    return (row) => ends.map((columns) => columns.map((values) => values[row]!));
  }

  private rates(view: MotionView, order: 1 | 2): Ends {
    const rate = ({ dx, dy, ddx, ddy }: Point): readonly [Float64Array, Float64Array] => (order === 1 ? [dx, dy] : [ddx, ddy]);
    const factor = (view.data.speed || 1) ** order;
    const points = view.points.filter((point) => point.moving);
    const rates = points.map(rate);
    let largest = 0;
    for (const [dx, dy] of rates) {
      largest = Math.max(largest, ...usual(view.order.map((row) => Math.hypot(dx[row]!, dy[row]!))));
    }
    const speed = view.data.speed;
    const per = speed ? "s" : this.data.derivative_unit;
    const by = `${per}${order === 2 ? "²" : ""}`;
    const scale = factor * this.scaled(Math.abs(factor) * largest, order === 1 ? "Velocity" : "Acceleration", `${this.data.length_unit || "1"}/${by}`);
    for (const point of points) this.add(order === 1 ? "lw-velocity" : "lw-acceleration", `${order === 1 ? "v" : "a"}(${point.shown})`);
    return (row) =>
      points.map(({ x, y }, k) => {
        const [dx, dy] = rates[k]!;
        return [x[row]!, y[row]!, x[row]! + scale * dx[row]!, y[row]! + scale * dy[row]!];
      });
  }

  /** Given forces, and those of pins and loads in every row. */
  private forces(view: MotionView): Ends {
    const given = this.data.forces.map(({ point, x, y }) => ({ point, name: `F(${view.points[point]!.shown})`, at: () => [x, y] as const }));
    const found = forcesOf(view).map((force) => ({ point: force.point, name: force.name, at: force.at }));
    const all = [...given, ...found];
    const sizes = all.flatMap(({ at }) => usual(view.order.map((row) => Math.hypot(...at(row)))));
    const unit = given.length ? this.data.force_unit : forceUnit(view);
    const largest = Math.max(0, ...sizes);
    const scale = this.scaled(largest, "Force", unit);
    if (scale) {
      this.nothing = NOTHING * largest * scale;
      const least = `${trimmed(shortNumber(Number((LEAST * this.data.pin * this.each).toPrecision(2))))} ${unit}`.trim();
      this.legend += `\ndashed: below ${least}, not to scale`;
    }
    for (const { name } of all) this.add("lw-force", name);
    return (row) =>
      all.map(({ point, at }) => {
        const [px, py] = [view.points[point]!.x[row]!, view.points[point]!.y[row]!];
        const [x, y] = at(row);
        return [px, py, px + scale * x, py + scale * y];
      });
  }

  /** Drawn length per magnitude, a round number; sets the legend. */
  private scaled(largest: number, what: string, unit: string): number {
    this.legend = "";
    if (!(largest > 0)) return 0;
    const [left, bottom, right, top] = this.data.view as [number, number, number, number];
    const size = Math.max(right - left, top - bottom);
    const each = roundUp(largest / (LONGEST * size)); // the quantity per drawn unit of length
    this.each = each;
    const length = 10 ** Math.floor(Math.log10(LONGEST * size));
    const [shown, means] = [trimmed(shortNumber(length)), trimmed(shortNumber(each * length))];
    this.legend = `${what} scale: ${`${shown} ${this.data.length_unit}`.trim()} = ${`${means} ${unit}`.trim()}`;
    return 1 / each;
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
    let [dx, dy] = [x1! - x0!, y1! - y0!];
    let length = Math.hypot(dx, dy);
    const small = this.kind === "forces" && length > this.nothing && length < LEAST * this.data.pin;
    if (small) {
      const longer = (LEAST * this.data.pin) / length;
      [dx, dy, length] = [dx * longer, dy * longer, length * longer];
      [x1, y1] = [x0! + dx, y0! + dy];
    }
    arrow.shaft.setAttribute("stroke-dasharray", small ? `${0.7 * this.data.pin} ${0.5 * this.data.pin}` : "none");
    const long = Number.isFinite(length) && length > (this.kind === "vectors" ? 0.6 : SHORTEST) * this.data.pin;
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
    if (arrow.name) this.write(arrow.name, [x0!, y0!], [x1!, y1!], [ux, uy]);
  }

  /** Possible positions of a name: beside the middle of a loop vector; beyond or beside the tip of
   * an arrow at a point. */
  private write(name: SVGTextElement, tail: readonly [number, number], tip: readonly [number, number], along: readonly [number, number]): void {
    const [ux, uy] = along;
    const size = 0.85 * this.data.text;
    const half = 0.29 * size * name.textContent!.length;
    const beside = this.kind === "vectors";
    const [x0, y0] = beside ? [0.5 * (tail[0] + tip[0]), 0.5 * (tail[1] + tip[1])] : tip;
    const away = (u: number, v: number): Spot => {
      const far = (beside ? 0.85 : 0.75) * this.data.text + Math.abs(u) * half;
      return { x: x0 + far * u, y: y0 + far * v, half, height: 0.62 * size };
    };
    const places = beside ? [away(-uy, ux), away(uy, -ux)] : [away(ux, uy), away(-uy, ux), away(uy, -ux)];
    const place = this.names.freest(places);
    name.style.display = place ? "" : "none";
    if (!place) return;
    name.setAttribute("x", String(place.x));
    name.setAttribute("y", String(-place.y + 0.3 * size));
  }
}

/** The size that most rows do not exceed; none without rows. */
function usual(sizes: number[]): number[] {
  const known = sizes.filter(Number.isFinite).sort((a, b) => a - b);
  return known.slice(Math.floor(USUAL * (known.length - 1)), Math.floor(USUAL * (known.length - 1)) + 1);
}

/** Two corners of the box around the tips of arrows; empty without arrows. */
function corners(ends: readonly (readonly number[])[]): (readonly [number, number])[] {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [, , x, y] of ends) {
    if (!Number.isFinite(x! + y!)) continue;
    box[0] = Math.min(box[0]!, x!);
    box[1] = Math.min(box[1]!, y!);
    box[2] = Math.max(box[2]!, x!);
    box[3] = Math.max(box[3]!, y!);
  }
  return Number.isFinite(box[0]) ? [[box[0]!, box[1]!], [box[2]!, box[3]!]] : [];
}

/** The middle of a name, and half of its width and height. */
export interface Spot {
  readonly x: number;
  readonly y: number;
  readonly half: number;
  readonly height: number;
}

/** Places the names of all arrows in a row without overlap, inside the view. */
export class Names {
  private taken: Spot[] = [];

  constructor(public view: readonly number[]) {}

  begin(): void {
    this.taken = [];
  }

  /** Take the first free position. */
  freest(places: readonly Spot[]): Spot | undefined {
    const [left, bottom, right, top] = this.view as [number, number, number, number];
    const found = places.find(
      (one) =>
        one.x - one.half > left && one.x + one.half < right && one.y - one.height > bottom && one.y + one.height < top &&
        this.taken.every((other) => Math.abs(one.x - other.x) > one.half + other.half || Math.abs(one.y - other.y) > one.height + other.height),
    );
    if (found) this.taken.push(found);
    return found;
  }
}

/** The name of a vector without a direction named after a link: OA, not OA∠θ_crank. */
function short(name: string): string {
  return name.includes("_") ? name.replace(/∠.*/, "") : name;
}
