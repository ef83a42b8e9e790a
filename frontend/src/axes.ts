// Scales of charts: their ends, their ticks, and which curves share one.

import { degreeTicks, ticks } from "./numbers";
import type { Plottable } from "./quantities";

/** A linear scale from values to places. */
export interface Scale {
  readonly low: number;
  readonly high: number;
  readonly at: (value: number) => number;
}

/** Curves of one unit share a scale unless the range of one is this many times that of another. */
const SPANS = 20;

/** Share of the rows excluded at either end of the values of unbounded rates. */
const TAIL = 0.1;

/** Ratio of the range of all values to that of most, above which a rate is unbounded. */
const UNBOUNDED = 4;

/** Variations below this fraction of the values are rounding. */
const LEVEL = 1e-9;

export function scale(low: number, high: number, from: number, to: number, air = 0): Scale {
  const least = 1e-6 * Math.max(1, Math.abs(low), Math.abs(high));
  if (!(high - low > least)) [low, high] = [low - 0.5, high + 0.5];
  const room = air * (high - low);
  [low, high] = [low - room, high + room];
  return { low, high, at: (value) => from + ((value - low) / (high - low)) * (to - from) };
}

/** The smallest and largest of the finite values; of an unbounded rate, twice the range of most. */
export function ends(values: readonly number[], rate = false): [number, number] {
  const known = values.filter(Number.isFinite).sort((a, b) => a - b);
  if (!known.length) return [0, 0];
  const [low, high] = [known[0]!, known.at(-1)!];
  if (!rate) return [low, high];
  const last = known.length - 1;
  const [first, third] = [known[Math.round(TAIL * last)]!, known[Math.round((1 - TAIL) * last)]!];
  const most = third - first;
  if (!(most > 0) || high - low <= UNBOUNDED * most) return [low, high];
  return [Math.max(low, first - most / 2), Math.min(high, third + most / 2)];
}

/** Curves grouped by the axis that they share: equal units and similar ranges. */
export function grouped(curves: readonly Plottable[], order: readonly number[]): number[][] {
  const spans = curves.map(({ values, rate }) => {
    const [low, high] = ends(order.map((row) => values[row]!), rate);
    const size = Math.max(Math.abs(low), Math.abs(high));
    return high - low > LEVEL * size ? high - low : 0;
  });
  const groups: number[][] = [];
  curves.forEach(({ unit }, k) => {
    const fits = (group: readonly number[]): boolean =>
      curves[group[0]!]!.unit === unit && group.every((other) => similar(spans[k]!, spans[other]!));
    const own = groups.find(fits);
    if (own) own.push(k);
    else groups.push([k]);
  });
  return groups;
}

/** Whether two ranges are legible on one axis; a level line is on any. */
function similar(one: number, other: number): boolean {
  if (!one || !other) return true;
  return Math.max(one, other) <= SPANS * Math.min(one, other);
}

/** Round numbers along a scale. */
export function ticksOf({ low, high }: Scale, unit: string, about: number): number[] {
  return (unit === "deg" ? degreeTicks : ticks)(low, high, about);
}
