// The panels of charts: curves over an abscissa, polar plots, and hodographs.

import { ends, grouped, scale, ticksOf, type Scale } from "./axes";
import { lineOverInput, lineThrough } from "./curve";
import type { MotionView } from "./motion";
import { shortNumber, ticks, trimmed } from "./numbers";
import { quantityOf, splitRate, TIME, vectorOf, type Plottable } from "./quantities";
import { svg } from "./svg";

/** The abscissas that are not quantities. */
export const POLAR = "(polar)";
export const HODOGRAPH = "(hodograph)";

/** What a chart shows. */
export interface Wanted {
  readonly view: MotionView;
  /** The design before, whose curves are drawn pale. */
  readonly past: MotionView | null;
  readonly names: readonly string[];
  /** "" for the leading input. */
  readonly over: string;
  readonly width: number;
  readonly height: number;
  /** A panel whose scales are only enlarged, during a drag. */
  readonly before: Panel | null;
}

export interface Panel {
  /** Text for screen readers. */
  readonly title: string;
  /** Key of the grid. */
  readonly key: string;
  /** The ends of all scales. */
  readonly extents: readonly (readonly [number, number])[];
  /** Left, top, right, bottom of the curves. */
  readonly box: readonly [number, number, number, number];
  /** Whether the displayed row has a vertical line. */
  readonly upright: boolean;
  readonly lines: readonly string[];
  readonly past: readonly string[];
  grid(parent: Element): void;
  /** The place of a curve in a row. */
  at(curve: number, row: number): readonly [number, number];
}

const ABOVE = 12;
const BELOW = 20;
const SIDE = 52;
const MARGIN = 16;
const AIR = 0.06;

export function panelOf(wanted: Wanted): Panel {
  if (wanted.over === HODOGRAPH) return hodograph(wanted);
  return wanted.over === POLAR ? polar(wanted) : upright(wanted);
}

export function labelled({ shown, unit }: { readonly shown: string; readonly unit: string }): string {
  return unit ? `${shown} [${unit}]` : shown;
}

function digits(value: number): string {
  return trimmed(shortNumber(value, 5));
}

/** The quantities in a view; those that it does not have are level at NaN. */
function curvesOf(view: MotionView, names: readonly string[]): Plottable[] {
  return names.map((name) => quantityOf(view, name) ?? missing(view, name));
}

function missing(view: MotionView, name: string): Plottable {
  const values = new Float64Array(view.data.rows).fill(Number.NaN);
  return { name, shown: name, unit: "", values, rate: false, band: [] };
}

function abscissaOf(view: MotionView, over: string): Plottable {
  return quantityOf(view, over || view.input.name) ?? quantityOf(view, view.input.name) ?? missing(view, over);
}

/** The extents of all values of a group, of this design and the one before. */
function extentOf(group: readonly number[], wanted: Wanted, sets: readonly (readonly Plottable[])[]): [number, number] {
  const views = [wanted.view, wanted.past];
  const found = sets.flatMap((set, k) => {
    const { order } = views[k]!;
    return group.map((one) => ends(order.map((row) => set[one]!.values[row]!), set[one]!.rate));
  });
  return [Math.min(...found.map(([low]) => low)), Math.max(...found.map(([, high]) => high))];
}

function upright(wanted: Wanted): Panel {
  const { view, past, names, over, width, height, before } = wanted;
  const sets = [view, past].flatMap((one) => (one ? [curvesOf(one, names)] : []));
  const curves = sets[0]!;
  const groups = grouped(curves, view.order);
  const box = [SIDE, ABOVE, width - MARGIN - SIDE * Math.max(0, groups.length - 1), height - BELOW] as const;
  const across = abscissaOf(view, over);
  const overInput = over === "" || over === TIME || across.name === view.input.name;
  const [first, last] = ends(Array.from(across.values), across.rate);
  const x = scale(first, last, box[0], box[2], overInput ? 0 : AIR);
  const kept = before?.extents.length === groups.length ? before.extents : null;
  const ys = groups.map((group, k) => {
    let [low, high] = extentOf(group, wanted, sets);
    const level = high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high));
    if (level && curves[group[0]!]!.unit !== "deg") [low, high] = [low - 0.1 * (Math.abs(low) || 1), high + 0.1 * (Math.abs(high) || 1)];
    const room = kept ? 0 : AIR;
    if (kept) [low, high] = [Math.min(low, kept[k]![0]), Math.max(high, kept[k]![1])];
    return scale(low, high, box[3], box[1], room);
  });
  const axisOf = curves.map((_, k) => groups.findIndex((group) => group.includes(k)));
  const place = (set: readonly Plottable[], own: Plottable, k: number) => (row: number) =>
    [x.at(own.values[row]!), ys[axisOf[k]!]!.at(set[k]!.values[row]!)] as const;
  const line = (motion: MotionView, set: readonly Plottable[], k: number): string => {
    const own = abscissaOf(motion, over);
    const { values } = set[k]!;
    if (overInput) return lineOverInput(motion, own.values, values, (a, b) => [x.at(a), ys[axisOf[k]!]!.at(b)]);
    return lineThrough(motion, [own.values, values], place(set, own, k));
  };
  return {
    title: `${curves.map(labelled).join(", ")} over ${labelled(across)}`,
    key: [...groups.flat(), labelled(across), x.low, x.high, ...ys.flatMap(({ low, high }) => [low, high]), ...box, ...curves.map(labelled)].join(" "),
    extents: ys.map(({ low, high }) => [low, high]),
    box,
    upright: true,
    lines: curves.map((_, k) => line(view, curves, k)),
    past: past ? curves.map((_, k) => line(past, sets[1]!, k)) : [],
    grid: (parent) => {
      bands(parent, curves, groups, ys, box);
      axes(parent, { x, ys, box, across: across.unit, units: groups.map((group) => curves[group[0]!]!.unit), groups });
    },
    at: (k, row) => place(curves, across, k)(row),
  };
}

/** The recommended ranges of values. */
function bands(parent: Element, curves: readonly Plottable[], groups: readonly (readonly number[])[], ys: readonly Scale[], box: Panel["box"]): void {
  groups.forEach((group, k) => {
    const [low, high] = curves[group.find((one) => curves[one]!.band.length) ?? -1]?.band ?? [];
    if (low === undefined || high === undefined) return;
    const top = Math.max(box[1], ys[k]!.at(high));
    const bottom = Math.min(box[3], ys[k]!.at(low));
    if (bottom <= top) return;
    const band = svg("rect", { class: "lw-band", x: box[0], y: top, width: box[2] - box[0], height: bottom - top }, parent);
    svg("title", {}, band).textContent = `recommended: ${digits(low)} to ${digits(high)}`;
  });
}

interface Axes {
  readonly x: Scale;
  readonly ys: readonly Scale[];
  readonly box: Panel["box"];
  readonly across: string;
  readonly units: readonly string[];
  readonly groups: readonly (readonly number[])[];
}

function axes(parent: Element, { x, ys, box, across, units, groups }: Axes): void {
  const [left, top, right, bottom] = box;
  for (const value of ticksOf(x, across, Math.max(2, (right - left) / 62))) {
    const at = x.at(value);
    svg("line", { class: "lw-grid", x1: at, x2: at, y1: top, y2: bottom }, parent);
    svg("text", { x: at, y: bottom + 14, "text-anchor": "middle" }, parent).textContent = digits(value);
  }
  ys.forEach((y, k) => {
    const side = k === 0 ? left - 6 : right + 6 + SIDE * (k - 1);
    const own = groups.length > 1 ? `tone-${groups[k]![0]! + 1} lw-own-axis` : "";
    for (const value of ticksOf(y, units[k]!, Math.max(2, (bottom - top) / 36))) {
      const at = y.at(value);
      if (k === 0) svg("line", { class: "lw-grid", x1: left, x2: right, y1: at, y2: at }, parent);
      const anchor = k === 0 ? "end" : "start";
      svg("text", { class: own, x: side, y: at + 3.5, "text-anchor": anchor }, parent).textContent = digits(value);
    }
    if (k > 0) {
      const edge = right + SIDE * (k - 1);
      svg("line", { class: "lw-grid", x1: edge, x2: edge, y1: top, y2: bottom }, parent);
    }
  });
}

/** Radii over the input as angle, counter-clockwise from the right; the centre is 0 or below. */
function polar(wanted: Wanted): Panel {
  const { view, past, names, width, height, before } = wanted;
  const sets = [view, past].flatMap((one) => (one ? [curvesOf(one, names)] : []));
  const curves = sets[0]!;
  const every = curves.map((_, k) => k);
  let [low, high] = extentOf(every, wanted, sets);
  if (before?.extents[0]) [low, high] = [Math.min(low, before.extents[0][0]), Math.max(high, before.extents[0][1])];
  [low, high] = [Math.min(0, low), Math.max(0, high)];
  const size = Math.max(20, Math.min(width, height) / 2 - 18);
  const [cx, cy] = [width / 2, height / 2];
  const r = scale(low, high, 0, size);
  const turn = view.input.unit === "deg" ? Math.PI / 180 : 1;
  const place = (motion: MotionView, set: readonly Plottable[], k: number) => (row: number) => {
    const [angle, radius] = [turn * motion.input.values[row]!, r.at(set[k]!.values[row]!)];
    return [cx + radius * Math.cos(angle), cy - radius * Math.sin(angle)] as const;
  };
  const line = (motion: MotionView, set: readonly Plottable[], k: number): string =>
    lineThrough(motion, [set[k]!.values], place(motion, set, k));
  return {
    title: `${curves.map(labelled).join(", ")} around ${labelled(view.input)}`,
    key: ["polar", r.low, r.high, width, height].join(" "),
    extents: [[low, high]],
    box: [0, 0, width, height],
    upright: false,
    lines: curves.map((_, k) => line(view, curves, k)),
    past: past ? curves.map((_, k) => line(past, sets[1]!, k)) : [],
    grid: (parent) => rings(parent, r, [cx, cy], size),
    at: (k, row) => place(view, curves, k)(row),
  };
}

function rings(parent: Element, r: Scale, [cx, cy]: readonly [number, number], size: number): void {
  for (let k = 0; k < 12; k++) {
    const [cos, sin] = [Math.cos((k * Math.PI) / 6), Math.sin((k * Math.PI) / 6)];
    svg("line", { class: "lw-grid", x1: cx, y1: cy, x2: cx + size * cos, y2: cy - size * sin }, parent);
    if (k % 3 === 0) {
      const at = { x: cx + (size + 12) * cos, y: cy - (size + 9) * sin + 3.5, "text-anchor": "middle" };
      svg("text", at, parent).textContent = `${30 * k}°`;
    }
  }
  for (const value of ticks(r.low, r.high, 4)) {
    if (r.at(value) < 1) continue;
    svg("circle", { class: "lw-grid", cx, cy, r: r.at(value), fill: "none" }, parent);
    svg("text", { x: cx + 3, y: cy - r.at(value) + 11 }, parent).textContent = digits(value);
  }
}

/** Tips of vectors that start at the pole; both axes have one scale. */
function hodograph(wanted: Wanted): Panel {
  const { view, past, names, width, height, before } = wanted;
  const vectorsOf = (motion: MotionView): { x: ArrayLike<number>; y: ArrayLike<number>; shown: string; unit: string }[] =>
    names.map((name) => {
      const [own, rate] = splitRate(name);
      const point = motion.points.find((one) => one.name === own);
      const vector = point && rate ? vectorOf(motion, point, rate) : null;
      const none = new Float64Array(motion.data.rows).fill(Number.NaN);
      return { x: vector?.x ?? none, y: vector?.y ?? none, shown: name, unit: vector?.unit ?? "" };
    });
  const sets = [view, past].flatMap((one) => (one ? [{ motion: one, vectors: vectorsOf(one) }] : []));
  const extent = (axis: "x" | "y"): [number, number] => {
    const all = sets.flatMap(({ motion, vectors }) => vectors.map((one) => ends(motion.order.map((row) => one[axis][row]!), true)));
    const [low, high] = before?.extents[axis === "x" ? 0 : 1] ?? [0, 0];
    return [Math.min(0, low, ...all.map(([least]) => least)), Math.max(0, high, ...all.map(([, most]) => most))];
  };
  const [xs, ys] = [extent("x"), extent("y")];
  const box = [SIDE, ABOVE, width - MARGIN, height - BELOW] as const;
  const [wide, tall] = [xs[1] - xs[0] || 1, ys[1] - ys[0] || 1];
  const unit = Math.min((box[2] - box[0]) / wide, (box[3] - box[1]) / tall) / (1 + 2 * AIR);
  const along = (low: number, high: number, from: number, to: number): Scale => {
    const half = Math.abs(to - from) / unit / 2;
    return scale((low + high) / 2 - half, (low + high) / 2 + half, from, to);
  };
  const [x, y] = [along(...xs, box[0], box[2]), along(...ys, box[3], box[1])];
  const own = sets[0]!.vectors;
  const place = (set: typeof own, k: number) => (row: number) => [x.at(set[k]!.x[row]!), y.at(set[k]!.y[row]!)] as const;
  const line = ({ motion, vectors }: (typeof sets)[number], k: number): string =>
    lineThrough(motion, [vectors[k]!.x, vectors[k]!.y], place(vectors, k));
  return {
    title: `hodograph of ${own.map(labelled).join(", ")}`,
    key: ["hodograph", x.low, x.high, y.low, y.high, ...box].join(" "),
    extents: [xs, ys],
    box,
    upright: false,
    lines: own.map((_, k) => line(sets[0]!, k)),
    past: sets[1] ? own.map((_, k) => line(sets[1]!, k)) : [],
    grid: (parent) => {
      axes(parent, { x, ys: [y], box, across: "", units: [""], groups: [[0]] });
      const pole = svg("circle", { class: "lw-pole", cx: x.at(0), cy: y.at(0), r: 3 }, parent);
      svg("title", {}, pole).textContent = "pole";
    },
    at: (k, row) => place(own, k)(row),
  };
}
