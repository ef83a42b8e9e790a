// The page's data for other numbers: everything that is drawn and told, computed again.

import { measured } from "../numbers";
import { MotionView } from "../motion";
import type { Column, LimitMark, MotionData, PackedColumn, PageData, Part, PointData, SolverData } from "../page_data";
import { pointsThrough } from "../smooth";
import { dense, ready } from "../unpack";
import { March, type Found, type Program } from "./march";

/** A solved page; without one, why there is none. */
export interface Solved {
  readonly page: PageData | null;
  /** Where the branch ends, or why there is no position; "" where all is found. */
  readonly message: string;
}

/** Steps nearer than this many of the largest are neighbours on a closed motion. */
const MEETING = 1.5;
const SAME_PLACE = 1e-3;
/** Of a stroke: deviations from a path that are not seen. */
const UNSEEN = 0.05;
const STATUS = ["converged", "not reached: beyond the end of the branch"];
const PROOF = ["certified", "no position"];

/** Rows in the order of the motion, and whether the first follows the last. */
interface Order {
  readonly rows: readonly number[];
  readonly closed: boolean;
}

/** The columns of one solution: by point, column and turn. */
interface Drawn {
  readonly points: readonly (readonly Float64Array[])[];
  readonly columns: readonly (readonly Float64Array[])[];
  readonly angles: readonly Float64Array[];
  readonly residual: Float64Array;
}

export class SolvedPages {
  private readonly march: March;
  /** Values of the path in the order of the table, and increasing. */
  private readonly path: Float64Array;
  private readonly rising: Float64Array;
  private readonly base: MotionView;
  private readonly anchored: readonly (readonly [number, number])[][];

  constructor(
    readonly program: Program,
    private readonly data: SolverData,
    private readonly page: PageData,
  ) {
    this.march = new March(program, data);
    this.path = dense(data.path);
    this.rising = this.falls ? this.path.slice().reverse() : this.path;
    this.base = new MotionView(page.motions[0]!, page);
    this.anchored = page.motions[0]!.parts.map((part, k) => this.places(this.base, part, k));
  }

  private get falls(): boolean {
    return this.path[this.path.length - 1]! < this.path[0]!;
  }

  /** The page with other numbers; with its own numbers as it was written. */
  at(numbers: readonly number[]): Solved {
    if (this.data.sliders.every(({ value }, k) => value === numbers[k])) return { page: this.page, message: "" };
    const found = this.found(numbers);
    if (!found.fits) {
      return { page: null, message: "With these numbers the equations have another form: no link has such lengths, or a part changes sides." };
    }
    if (!found.t.some(Number.isFinite)) {
      const why = found.begun ? "no row of the table is on the branch" : "no position was found and proved from the sketch";
      return { page: null, message: `With these numbers ${why}.` };
    }
    return this.solved(numbers, found);
  }

  /** The numbers of a column, for scripts. */
  numbers(column: PackedColumn): Float64Array {
    return dense(column);
  }

  /** The positions with other numbers, by increasing values of the path. */
  found(numbers: readonly number[]): Found {
    return this.march.solve(numbers, this.rising);
  }

  private solved(numbers: readonly number[], found: Found): Solved {
    const count = this.path.length;
    const place = (row: number): number => (this.falls ? count - 1 - row : row);
    const drawn = this.drawn(found, place);
    const order = this.order(found, drawn, place);
    const ends = this.ends(found);
    const message = ends.length ? `The branch ends: a dead point is near ${ends.map(({ text }) => text).join(" and ")}.` : "";
    const motion = this.motion(found, drawn, order, place, ends, message, numbers);
    return { page: { ...this.page, motions: [motion], view: this.view(drawn, order.rows) }, message };
  }

  /** Points, columns, angles and residuals of the found rows. */
  private drawn(found: Found, place: (row: number) => number): Drawn {
    const { data, program } = this;
    const count = this.path.length;
    const v = new Float64Array(data.unknowns + data.rates.length);
    const o = new Float64Array(2 * data.unknowns + 1);
    const q = new Float64Array(data.drawn);
    const all = Array.from(q, () => new Float64Array(count).fill(NaN));
    const residual = new Float64Array(count).fill(NaN);
    for (let row = 0; row < count; row++) {
      const at = place(row);
      const t = found.t[at]!;
      if (Number.isNaN(t)) continue;
      v.set(found.v.subarray(at * data.unknowns, (at + 1) * data.unknowns));
      data.rates.forEach((rate, j) => (v[data.unknowns + j] = data.origins[j]! + rate * t));
      program.rates(v, found.d, o);
      program.drawn(v, found.d, o, q);
      for (let k = 0; k < q.length; k++) all[k]![row] = Number.isFinite(q[k]) ? q[k]! : NaN;
      residual[row] = o[o.length - 1]!;
    }
    const points = this.base.points.length;
    const columns = data.columns.length;
    return {
      points: this.base.points.map((_, k) => all.slice(6 * k, 6 * k + 6)),
      columns: data.columns.map((_, k) => all.slice(6 * points + 2 * k, 6 * points + 2 * k + 2)),
      angles: all.slice(6 * points + 2 * columns),
      residual,
    };
  }

  /** As viewer/play_order.py orders one branch. */
  private order(found: Found, { points }: Drawn, place: (row: number) => number): Order {
    const rows = Array.from(this.path.keys()).filter((row) => !Number.isNaN(found.t[place(row)]!));
    rows.sort((a, b) => found.t[place(a)]! - found.t[place(b)]!);
    const apart = (a: number, b: number): number =>
      most(points.map(([x, , , y]) => Math.hypot(x![a]! - x![b]!, y![a]! - y![b]!)));
    const near = MEETING * most(rows.map((row, k) => apart(row, rows[Math.max(0, k - 1)]!)));
    const gap = apart(rows[0]!, rows[rows.length - 1]!);
    const closed = rows.length === this.path.length && rows.length > 2 && gap <= near;
    if (closed && gap < SAME_PLACE * near) rows.pop();
    if (closed) {
      const first = rows.indexOf(least(rows));
      rows.push(...rows.splice(0, first));
    }
    const backwards = this.page.motions[0]!.speed < 0;
    if (backwards) {
      rows.reverse();
      if (closed) rows.unshift(rows.pop()!);
    }
    return { rows, closed };
  }

  /** Where the march stopped, in the unit of the input. */
  private ends(found: Found): { readonly at: number; readonly text: string }[] {
    const whole = found.t.every(Number.isFinite);
    return found.ends.flatMap((t, way) => {
      if (whole || Number.isNaN(t)) return [];
      const rows = Array.from(found.t.keys()).filter((row) => Number.isFinite(found.t[row]!));
      const at = rows.reduce((best, row) => ((found.t[row]! - found.t[best]!) * (2 * way - 1) > 0 ? row : best));
      return [{ at, text: measured(Number((t / this.data.input_unit).toPrecision(6)), this.page.input_unit) }];
    });
  }

  private motion(
    found: Found,
    drawn: Drawn,
    order: Order,
    place: (row: number) => number,
    ends: readonly { readonly at: number; readonly text: string }[],
    message: string,
    numbers: readonly number[],
  ): MotionData {
    const { data } = this;
    const base = this.page.motions[0]!;
    const count = this.path.length;
    const there = Float64Array.from(this.path, (_, row) => (Number.isNaN(found.t[place(row)]!) ? 0 : 1));
    const missing = there.map((is) => 1 - is);
    const sorted = (values: Float64Array): Float64Array => Float64Array.from(values, (_, row) => values[place(row)]!);
    const reached = there.reduce((sum, is) => sum + is, 0);
    const told = `${reached === count ? count : `${reached} of ${count}`} positions found, each proved`;
    const limits: LimitMark[] = ends.map(({ at, text }) => ({ row: place(at), text: `the branch ends near ${text}` }));
    const motion: MotionData = {
      ...base,
      summary: `${told}${message && `. ${message}`}`,
      rows: count,
      order: ready(Float64Array.from(order.rows)),
      closed: order.closed,
      columns: this.columns(drawn),
      points: base.points.map((point, k) => pointOf(point, drawn.points[k]!)),
      turns: base.turns.map((turn, k) => ({ ...turn, angle: ready(this.angle(k, drawn)) })),
      frames: data.frames,
      vectors: base.vectors.filter(({ course }) => !course.length),
      evidence: {
        found: ready(there),
        status: ready(missing),
        status_texts: STATUS,
        certification: ready(missing),
        certification_texts: PROOF,
        certified: ready(there),
        residual_log10: ready(drawn.residual.map((one) => (one > 0 ? Math.log10(one) : -400))),
        radius_log10: ready(sorted(found.radius).map(Math.log10)),
        iterations: ready(sorted(found.steps)),
        branch: ready(new Float64Array(count)),
        branch_names: [""],
      },
      limits,
      answers: [],
      reactions: [], // their columns are not solved
      numbers: [],
    };
    return { ...motion, parts: this.parts(motion, order.rows, numbers) };
  }

  /** Inputs, and the columns that the solver computes: others are not shown. */
  private columns(drawn: Drawn): Column[] {
    const [inputs, rest] = [[] as Column[], [] as Column[]];
    for (const column of this.page.motions[0]!.columns) {
      const k = this.data.columns.indexOf(column.name);
      if (column.group === "input") {
        inputs.push({ ...column, values: this.data.inputs[inputs.length]! });
      } else if (k >= 0) {
        const [values, first] = drawn.columns[k]!;
        rest.push({ ...column, values: ready(values!), first: ready(first!) });
      }
    }
    return [...inputs, ...rest];
  }

  private angle(turn: number, { points, angles }: Drawn): Float64Array {
    const { angle, start, end } = this.data.turns[turn]!;
    if (angle >= 0) return angles[angle]!;
    const [x0, , , y0] = points[start]!;
    const [x1, , , y1] = points[end]!;
    return this.path.map((_, row) => Math.atan2(y1![row]! - y0![row]!, x1![row]! - x0![row]!));
  }

  private parts(motion: MotionData, rows: readonly number[], numbers: readonly number[]): Part[] {
    const view = new MotionView(motion, this.page);
    const hidden = new Set(
      this.data.sliders.flatMap((slider, k) => (slider.value === numbers[k] ? [] : slider.hidden)),
    );
    return motion.parts.map((part, k) => {
      if (hidden.has(k)) return nothing(part);
      if (part.role === "trace") return { ...part, points: pathOf(view, rows, part.of, motion.closed, UNSEEN * this.page.stroke) };
      const before = this.anchored[k]!;
      if (!before.length) return part;
      const now = this.places(view, part, k, rows[0]);
      const points = part.points.map((x, i) => {
        const [corner, axis] = [i >> 1, i % 2];
        return x + now[corner]![axis]! - before[corner]![axis]!;
      });
      return { ...part, points };
    });
  }

  /** Where the points that the corners of a part move with are, in its frame. */
  private places(view: MotionView, part: Part, k: number, row = view.order[0]!): (readonly [number, number])[] {
    const named = view.points.length;
    const ends = new Map<number, readonly [number, number]>();
    return this.data.anchors[k]!.map((anchor) => {
      if (anchor < named) return placeIn(view, part.frame, anchor, row);
      const end = ends.get(anchor) ?? this.end(view, anchor - named);
      ends.set(anchor, end);
      return end;
    });
  }

  /** An end of the path on a track, in its frame. */
  private end(view: MotionView, number: number): readonly [number, number] {
    const { point, frame, x, y } = this.data.tracks[number >> 1]!;
    const sign = number % 2 ? 1 : -1;
    const path = view.order.map((row) => placeIn(view, frame, point, row));
    return path.reduce((a, b) => (sign * ((b[0] - a[0]) * x + (b[1] - a[1]) * y) > 0 ? b : a));
  }

  /** The view of the page, enlarged: around the points there is as much room as before. */
  private view({ points }: Drawn, rows: readonly number[]): number[] {
    const now = extent(points.map(([x, , , y]) => ({ x: x!, y: y! })), rows);
    const before = extent(this.base.points, this.base.order);
    return this.page.view.map((side, k) => (k < 2 ? Math.min : Math.max)(side, side + now[k]! - before[k]!));
  }
}

/** A point in a frame. */
function placeIn(view: MotionView, frame: number, point: number, row: number): readonly [number, number] {
  const pose = view.pose(frame, row);
  const { x, y } = view.points[point]!;
  const [cos, sin] = [Math.cos(pose.angle), Math.sin(pose.angle)];
  const [dx, dy] = [x[row]! - pose.x, y[row]! - pose.y];
  return [cos * dx + sin * dy, -sin * dx + cos * dy];
}

/** Left, bottom, right, top of points over some rows. */
function extent(points: readonly { readonly x: Float64Array; readonly y: Float64Array }[], rows: readonly number[]): number[] {
  const xs = points.flatMap(({ x }) => rows.map((row) => x[row]!));
  const ys = points.flatMap(({ y }) => rows.map((row) => y[row]!));
  return [least(xs), least(ys), most(xs), most(ys)];
}

function least(numbers: readonly number[]): number {
  return numbers.reduce((a, b) => Math.min(a, b));
}

function most(numbers: readonly number[]): number {
  return numbers.reduce((a, b) => Math.max(a, b));
}

function pointOf(point: PointData, columns: readonly Float64Array[]): PointData {
  const [x, dx, ddx, y, dy, ddy] = columns.map(ready) as [
    PackedColumn, PackedColumn, PackedColumn, PackedColumn, PackedColumn, PackedColumn,
  ];
  return { ...point, x, dx, ddx, y, dy, ddy };
}

/** The path of a point over the rows: x, y, x, y, … */
function pathOf(view: MotionView, rows: readonly number[], name: string, closed: boolean, unseen: number): number[] {
  const point = view.points.find((one) => one.name === name);
  if (!point) return [];
  const around = closed ? [...rows, rows[0]!] : rows;
  return pointsThrough(around.map((row) => [point.x[row]!, point.y[row]!]), unseen);
}

/** A part of which nothing is seen; its elements stay. */
function nothing(part: Part): Part {
  switch (part.kind) {
    case "disc":
      return { ...part, radius: 0 };
    case "text":
      return { ...part, text: "" };
    default:
      return { ...part, points: part.kind === "line" ? [0, 0] : [], head: [], shown: part.shown && ready(dense(part.shown).fill(0)) };
  }
}
