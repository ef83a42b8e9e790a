// The line of a quantity over an abscissa, interrupted at gaps and jumps.

import type { MotionView } from "./motion";
import { curveThrough, type Spot } from "./smooth";

/** A place on the chart. */
export type Place = (row: number) => readonly [number, number];

type Values = ArrayLike<number>;

/** A line over the leading input, or a linear function of it: a circuit that reverses at dead
 * points is one closed curve; a line that leaves at one side continues at the other. */
export function lineOverInput(view: MotionView, x: Values, y: Values, at: (x: number, y: number) => readonly [number, number]): string {
  const { order, data } = view;
  const [low, high] = range(order.map((row) => x[row]!));
  const wide = (high - low) / 2;
  const usual = usualStep(order, x);
  const first = Math.abs(x[order[1] ?? order[0]!]! - x[order[0]!]!);
  const pen = new Pen();
  const jumps = eventsOf(view);
  let last = -1;
  for (const row of data.closed ? [...order, order[0]!] : order) {
    const value = x[row]!;
    const before = last < 0 ? Number.NaN : x[last]!;
    const far = Math.abs(value - before);
    if (far > wide) {
      // The curve continues at the other side, one turn further: end it at the edge.
      const turned = before + Math.sign(before - value) * first;
      const end = rowAt(view, x, y, turned, y[last]!);
      if (end !== null) pen.to(at(turned, y[end]!));
    }
    if (last < 0 || far > wide || (far > 1.5 * usual && isGap(view, last, row))) pen.lift();
    pen.to(at(value, y[row]!));
    if (jumps.has(row) || jumps.has(last)) pen.corner();
    last = row;
  }
  return pen.path;
}

/** A line through the rows in order, interrupted where rows have no position or values jump. */
export function lineThrough(view: MotionView, values: readonly Values[], place: Place): string {
  const { order, data } = view;
  const wide = values.map((one) => {
    const [low, high] = range(order.map((row) => one[row]!));
    return 0.5 * (high - low);
  });
  const usual = usualStep(order, view.input.values);
  const pen = new Pen();
  const jumps = eventsOf(view);
  let last = -1;
  for (const row of data.closed ? [...order, order[0]!] : order) {
    const jump = last >= 0 && order.length > 8 && values.some((one, k) => Math.abs(one[row]! - one[last]!) > wide[k]! && wide[k]! > 0);
    const input = view.input.values;
    const gap = last >= 0 && Math.abs(input[row]! - input[last]!) > 1.5 * usual && isGap(view, last, row);
    if (jump || gap) pen.lift();
    pen.to(place(row));
    if (jumps.has(row) || jumps.has(last)) pen.corner();
    last = row;
  }
  return pen.path;
}

/** The rows of a motion in time at which speeds or forces may jump. */
function eventsOf(view: MotionView): ReadonlySet<number> {
  return new Set(view.times ? view.data.limits.map(({ row }) => row) : []);
}

/** Writes a smooth path; places that are not finite interrupt it. */
class Pen {
  private readonly pieces: string[] = [];
  private run: Spot[] = [];

  get path(): string {
    this.lift();
    return this.pieces.join("");
  }

  lift(): void {
    if (this.run.length) this.pieces.push(curveThrough(this.run));
    this.run = [];
  }

  /** The path goes on from its last place in any direction. */
  corner(): void {
    const [last] = this.run.slice(-1);
    this.lift();
    if (last) this.run = [last];
  }

  to(spot: Spot): void {
    if (spot.every(Number.isFinite)) this.run.push(spot);
    else this.lift();
  }
}

function range(values: readonly number[]): [number, number] {
  const known = values.filter(Number.isFinite);
  return known.length ? [Math.min(...known), Math.max(...known)] : [0, 0];
}

/** The table row at an abscissa whose value is nearest to another; null without one. */
function rowAt(view: MotionView, x: Values, y: Values, wanted: number, beside: number): number | null {
  const [low, high] = range(Array.from(x));
  const [least, most] = range(Array.from(y));
  let best: number | null = null;
  let nearest = 0.2 * (most - least);
  view.found.forEach((found, row) => {
    if (!found || !(Math.abs(x[row]! - wanted) <= 1e-6 * (high - low))) return;
    const far = Math.abs(y[row]! - beside);
    if (far < nearest) [best, nearest] = [row, far];
  });
  return best;
}

/** Whether there are rows without a position between two table rows. */
function isGap(view: MotionView, one: number, other: number): boolean {
  return !view.found.slice(Math.min(one, other), Math.max(one, other)).every(Boolean);
}

function usualStep(order: readonly number[], x: Values): number {
  const steps = order.slice(1).map((row, k) => Math.abs(x[row]! - x[order[k]!]!));
  return steps.sort((a, b) => a - b)[Math.floor(steps.length / 2)] ?? 0;
}
