// A motion as arrays over its rows, for the drawing, the plots and the table.

import type { Column, MotionData, PackedColumn, PageData, Part, PointData } from "./page_data";
import { dense, unpacked } from "./unpack";

/** A frame in one row: its origin and its angle [rad]. */
export interface Pose {
  readonly x: number;
  readonly y: number;
  readonly angle: number;
}

export interface Series {
  readonly name: string;
  readonly shown: string;
  readonly unit: string;
  readonly group: string;
  readonly values: Float64Array;
  readonly first: Float64Array | null;
  readonly firstUnit: string;
  /** Recommended values: lowest and highest, or none. */
  readonly band: readonly number[];
}

export interface Point {
  readonly name: string;
  readonly shown: string;
  readonly moving: boolean;
  readonly x: Float64Array;
  readonly y: Float64Array;
  readonly dx: Float64Array;
  readonly dy: Float64Array;
  readonly ddx: Float64Array;
  readonly ddy: Float64Array;
}

export interface Course {
  readonly corners: readonly Float64Array[];
  readonly shown: Float64Array;
}

export class MotionView {
  readonly found: readonly boolean[];
  /** Found rows in the order of the motion. */
  readonly order: readonly number[];
  readonly series: readonly Series[];
  readonly points: readonly Point[];
  readonly turns: readonly Float64Array[];
  readonly status: Float64Array;
  readonly certification: Float64Array;
  readonly certified: Float64Array;
  readonly residual: Float64Array;
  readonly radius: Float64Array;
  readonly iterations: Float64Array;
  readonly branch: Float64Array;
  readonly lengthUnit: string;
  /** The unit of the input in derivatives. */
  readonly derivativeUnit: string;

  /** Whether rates of points have been read. */
  ratesRead = false;

  constructor(
    readonly data: MotionData,
    units: Pick<PageData, "length_unit" | "derivative_unit">,
  ) {
    this.lengthUnit = units.length_unit;
    this.derivativeUnit = units.derivative_unit;
    const evidence = data.evidence;
    this.found = Array.from(dense(evidence.found), (is) => is === 1);
    const own: Own = (column) => unpacked(column, this.found);
    this.order = Array.from(dense(data.order));
    this.series = data.columns.map((column) => seriesOf(column, own));
    this.points = data.points.map((point) => pointOf(point, own, () => (this.ratesRead = true)));
    this.turns = data.turns.map((turn) => own(turn.angle));
    this.status = dense(evidence.status);
    this.certification = dense(evidence.certification);
    this.certified = dense(evidence.certified);
    this.residual = own(evidence.residual_log10).map((exponent) => 10 ** exponent);
    this.radius = own(evidence.radius_log10).map((exponent) => 10 ** exponent);
    this.iterations = own(evidence.iterations);
    this.branch = dense(evidence.branch);
  }

  /** The leading input. */
  get input(): Series {
    return this.series[0] ?? STILL;
  }

  /** The times of the rows in order [s], if the motion is over the time; they do not fall. */
  get times(): Float64Array | null {
    const { name, unit, values } = this.input;
    return name === "t" && unit === "s" ? Float64Array.from(this.order, (row) => values[row]!) : null;
  }

  /** Whether the input decreases at a row in the order of the motion. */
  falls(index: number): boolean {
    const value = (k: number): number => this.input.values[this.order[k]!]!;
    const last = this.order.length - 1;
    const turn = { deg: 360, rad: 2 * Math.PI }[this.input.unit];
    const from = (a: number, b: number): number => (turn ? shorter(value(b) - value(a), turn) : value(b) - value(a));
    const after = index < last ? from(index, index + 1) : NaN;
    const before = index > 0 ? from(index - 1, index) : NaN;
    // At a dead point the following step counts; at the end of a turn, the preceding one.
    return Number.isFinite(after) ? after < 0 : before < 0;
  }

  /** Whether arrows of inputs are reversed relative to the drawing, at an index passed forwards or
   * backwards. */
  turned(index: number, back: boolean): boolean {
    return (this.falls(index) !== back) !== this.data.backwards;
  }

  /** The position of a frame in a row; -1 is the ground. */
  pose(frame: number, row: number): Pose {
    const at = this.data.frames[frame];
    if (at === undefined) return { x: 0, y: 0, angle: 0 };
    const origin = this.points[at.origin];
    return {
      x: origin?.x[row] ?? 0,
      y: origin?.y[row] ?? 0,
      angle: this.turns[at.turn]?.[row] ?? 0,
    };
  }

  /** A column of all rows. */
  numbers(column: PackedColumn): Float64Array {
    return unpacked(column, this.found);
  }

  /** The coordinates of a deforming shape. */
  course(part: Part): Course {
    return {
      corners: part.course.map((column) => this.numbers(column)),
      shown: dense(part.shown!),
    };
  }

  /** The path of a point fixed in a frame, over the rows in order: x and y alternating. */
  wayOf(frame: number, local: readonly [number, number]): Float64Array {
    const way = new Float64Array(2 * this.order.length);
    this.order.forEach((row, k) => {
      const { x, y, angle } = this.pose(frame, row);
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      way[2 * k] = x + cos * local[0] - sin * local[1];
      way[2 * k + 1] = y + sin * local[0] + cos * local[1];
    });
    return way;
  }
}

/** The input of a drawing of one position. */
const STILL: Series = { name: "", shown: "", unit: "", group: "input", values: new Float64Array(1), first: null, firstUnit: "", band: [] };

/** A difference of angles, within half a turn. */
function shorter(angle: number, turn: number): number {
  return angle - turn * Math.round(angle / turn);
}

/** Numbers that are unpacked on first use. */
function lazily<T>(make: () => T): () => T {
  let made: { readonly value: T } | null = null;
  return () => (made ??= { value: make() }).value;
}

type Own = (packed: Column["values"]) => Float64Array;

function seriesOf(column: Column, own: Own): Series {
  const first = lazily(() => column.first && own(column.first));
  return {
    name: column.name,
    shown: column.shown,
    unit: column.unit.replace("^2", "²"),
    group: column.group,
    values: own(column.values),
    get first() {
      return first();
    },
    firstUnit: column.first_unit.replace("^2", "²"),
    band: column.band,
  };
}

/** `read` hears of every rate that is read. */
function pointOf(point: PointData, own: Own, read: () => void): Point {
  const rates = lazily(() => (read(), { dx: own(point.dx), dy: own(point.dy) }));
  const second = lazily(() => (read(), { ddx: own(point.ddx), ddy: own(point.ddy) }));
  return {
    name: point.name,
    shown: point.shown,
    moving: point.drawn,
    x: own(point.x),
    y: own(point.y),
    get dx() {
      return rates().dx;
    },
    get dy() {
      return rates().dy;
    },
    get ddx() {
      return second().ddx;
    },
    get ddy() {
      return second().ddy;
    },
  };
}
