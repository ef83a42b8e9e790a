// The quantities that a page can plot, found by the names of the registry: columns of the data,
// coordinates of points, their rates, and the time.

import type { MotionView, Point } from "./motion";

/** A rate as in names of quantities: `rocker.d1`, `B.velocity`. */
export type Rate = "" | "d1" | "d2" | "velocity" | "acceleration";

export const RATES: readonly Rate[] = ["", "d1", "d2", "velocity", "acceleration"];

/** The name of the time as abscissa. */
export const TIME = "time";

/** Numbers over the rows. */
export interface Plottable {
  readonly name: string;
  readonly shown: string;
  readonly unit: string;
  readonly values: ArrayLike<number>;
  /** A derivative, which is unbounded near a dead point. */
  readonly rate: boolean;
  /** Recommended values: lowest and highest. */
  readonly band: readonly number[];
}

/** A quantity to choose, without its rate. */
export interface Choice {
  readonly name: string;
  readonly shown: string;
  readonly unit: string;
  readonly group: string;
  /** The highest derivative that the program can compute. */
  readonly orders?: number | undefined;
}

/** A name without its rate, and the rate. */
export function splitRate(name: string): [string, Rate] {
  const dot = name.lastIndexOf(".");
  const rate = name.slice(dot + 1) as Rate;
  return dot > 0 && RATES.includes(rate) && rate ? [name.slice(0, dot), rate] : [name, ""];
}

export function joined(own: string, rate: Rate): string {
  return rate ? `${own}.${rate}` : own;
}

/** The quantity of a name; `null` if the page does not contain it. */
export function quantityOf(view: MotionView, name: string): Plottable | null {
  const kept = known(view);
  if (!kept.has(name)) kept.set(name, found(view, name));
  return kept.get(name)!;
}

const memory = new WeakMap<MotionView, Map<string, Plottable | null>>();

function known(view: MotionView): Map<string, Plottable | null> {
  let kept = memory.get(view);
  if (!kept) memory.set(view, (kept = new Map()));
  return kept;
}

function found(view: MotionView, name: string): Plottable | null {
  const column = view.series.find((one) => one.name === name);
  if (column) {
    const { shown, unit, values, band } = column;
    return { name, shown, unit, values, rate: splitRate(name)[1] !== "", band };
  }
  if (name === TIME) return timeOf(view);
  const [own, rate] = splitRate(name);
  const point = view.points.find((one) => one.name === own);
  if (point && rate) return sizeOf(view, point, rate);
  const jet = jetOf(view, own);
  if (jet === null) return null;
  const [values, unit] = rated(view, jet, rate);
  if (values === null) return null;
  return { name, shown: rateName(view, jet.shown, rate), unit, values, rate: rate !== "", band: [] };
}

interface Jet {
  readonly shown: string;
  readonly unit: string;
  /** The unit in derivatives. */
  readonly of: string;
  readonly values: ArrayLike<number>;
  readonly first: ArrayLike<number> | null;
  readonly second: ArrayLike<number> | null;
}

/** A quantity with its derivatives. */
function jetOf(view: MotionView, own: string): Jet | null {
  const column = view.series.find((one) => one.name === own);
  if (column) {
    const { shown, unit, values, first, firstUnit } = column;
    return { shown, unit, of: firstUnit.split("/").slice(0, -1).join("/"), values, first, second: null };
  }
  const [name, axis] = [own.slice(0, -2), own.slice(-1)];
  const point = view.points.find((one) => one.name === name);
  if (!point || !(own.endsWith(".x") || own.endsWith(".y"))) return null;
  const length = view.lengthUnit;
  return {
    ...{ shown: `${point.shown}.${axis}`, unit: length, of: length, values: axis === "x" ? point.x : point.y },
    get first() {
      return axis === "x" ? point.dx : point.dy;
    },
    get second() {
      return axis === "x" ? point.ddx : point.ddy;
    },
  };
}

/** The values of a rate and their unit. */
function rated(view: MotionView, jet: Jet, rate: Rate): [ArrayLike<number> | null, string] {
  if (!rate) return [jet.values, jet.unit];
  const derivative = orderOf(rate) === 1 ? jet.first : jet.second;
  const factor = factorOf(view, rate);
  if (derivative === null || factor === null) return [null, ""];
  return [Float64Array.from(derivative, (one) => factor * one), rateUnit(view, jet.of, rate)];
}

function orderOf(rate: Rate): 1 | 2 {
  return rate === "d1" || rate === "velocity" ? 1 : 2;
}

/** The power of the input's speed in a rate; `null` if the input has no speed. */
function factorOf(view: MotionView, rate: Rate): number | null {
  if (rate === "d1" || rate === "d2") return 1;
  const { speed } = view.data;
  return speed ? speed ** orderOf(rate) : null;
}

function rateUnit(view: MotionView, of: string, rate: Rate): string {
  const byTime = rate === "velocity" || rate === "acceleration";
  return `${of || "1"}/${byTime ? "s" : view.derivativeUnit}${orderOf(rate) === 2 ? "²" : ""}`;
}

/** The printed name of a rate: dB.x/dcrank, velocity of rocker. */
function rateName(view: MotionView, shown: string, rate: Rate): string {
  if (!rate) return shown;
  if (rate === "velocity" || rate === "acceleration") return `${rate} of ${shown}`;
  const power = orderOf(rate) === 2 ? "²" : "";
  return `d${power} ${shown}/d ${view.input.shown}${power}`;
}

/** The length of a vector of a point. */
function sizeOf(view: MotionView, point: Point, rate: Rate): Plottable | null {
  const pair = vectorOf(view, point, rate);
  if (pair === null) return null;
  const values = Float64Array.from(pair.x, (x, row) => Math.hypot(x, pair.y[row]!));
  const shown = `|${rateName(view, point.shown, rate)}|`;
  return { name: joined(point.name, rate), shown, unit: pair.unit, values, rate: true, band: [] };
}

/** The vector of a point's rate over the rows; `null` if the input has no speed. */
export function vectorOf(
  view: MotionView,
  point: Point,
  rate: Rate,
): { readonly x: Float64Array; readonly y: Float64Array; readonly unit: string } | null {
  const factor = factorOf(view, rate);
  if (factor === null) return null;
  const [x, y] = orderOf(rate) === 1 ? [point.dx, point.dy] : [point.ddx, point.ddy];
  const scaled = (of: Float64Array): Float64Array => of.map((one) => factor * one);
  return { x: scaled(x), y: scaled(y), unit: rateUnit(view, view.lengthUnit, rate) };
}

/** Time since the first row at constant speed; `null` if branches reverse the input. */
function timeOf(view: MotionView): Plottable | null {
  const { speed, evidence } = view.data;
  if (!speed || evidence.branch_names.filter(Boolean).length > 1) return null;
  const { values, unit } = view.input;
  const internal = unit === "deg" ? Math.PI / 180 : 1;
  const began = values[speed > 0 ? 0 : values.length - 1]!;
  const passed = Float64Array.from(values, (one) => ((one - began) * internal) / speed);
  return { name: TIME, shown: TIME, unit: "s", values: passed, rate: false, band: [] };
}

/** All quantities in the data; rates are chosen besides. */
export function choicesOf(view: MotionView): Choice[] {
  const groups: Readonly<Record<string, string>> = { unknown: "Unknowns", output: "Outputs", derived: "Derived" };
  const columns = view.series
    .filter((one) => one.group in groups && !splitRate(one.name)[1])
    .map(({ name, shown, unit, group }) => ({ name, shown, unit, group: groups[group]! }));
  const moving = view.points.filter((point) => point.moving);
  const unit = view.lengthUnit;
  const coordinates = moving.flatMap(({ name, shown }) =>
    ["x", "y"].map((axis) => ({ name: `${name}.${axis}`, shown: `${shown}.${axis}`, unit, group: "Coordinates" })),
  );
  return [...columns, ...coordinates, ...moving.map(({ name, shown }) => ({ name, shown, unit: "", group: POINTS }))];
}

/** The group of points, which have rates only. */
export const POINTS = "Points";

/** The rates of a quantity in the data, and those that can be asked for up to an order. */
export function ratesOf(view: MotionView, own: string, orders = 0): Rate[] {
  const point = view.points.some((one) => one.name === own);
  return RATES.filter((rate) => {
    if (quantityOf(view, joined(own, rate)) !== null) return true;
    return !point && (rate === "" || (orderOf(rate) <= orders && factorOf(view, rate) !== null));
  });
}
