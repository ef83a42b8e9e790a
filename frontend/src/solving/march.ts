// The march of one mechanism along its table, as kernels/gpu/march.py and marching/ do it.

import type { SolverData, StepRules } from "../page_data";
import { sinCos, turn } from "./sine";

type Section = (w: Float64Array) => void;

/** The printed functions of one mechanism; see batch/printed_solver.py. */
export interface Program {
  readonly design: (x: ArrayLike<number>, d: Float64Array) => void;
  readonly reach: Section;
  readonly given: Section;
  readonly agree: Section;
  readonly begin: readonly Section[];
  readonly damped: readonly Section[];
  readonly iterate: readonly Section[];
  readonly prove: readonly Section[];
  readonly rates: (v: Float64Array, d: Float64Array, o: Float64Array) => void;
  readonly drawn: (v: Float64Array, d: Float64Array, o: Float64Array, q: Float64Array) => void;
}

/** Makes a program from the functions that it calls. */
export type Printed = (
  abs: typeof Math.abs,
  sqrt: typeof Math.sqrt,
  atan2: typeof Math.atan2,
  sinCos: (x: number) => void,
  turn: Float64Array,
) => Program;

export function programOf(printed: Printed): Program {
  return printed(Math.abs, Math.sqrt, Math.atan2, sinCos, turn);
}

/** What a march found: a row has its t where it was reached, else NaN. */
export interface Found {
  /** Whether the equations keep their form with these numbers. */
  readonly fits: boolean;
  /** Whether the march began: a position was found and proved from the sketch. */
  readonly begun: boolean;
  readonly d: Float64Array;
  /** The value of the path in every row, whole turns included. */
  readonly t: Float64Array;
  /** Unknowns, row by row. */
  readonly v: Float64Array;
  readonly radius: Float64Array;
  /** Newton-Raphson steps of the row, of the block that needed most. */
  readonly steps: Float64Array;
  /** How far the march came downwards and upwards where it stopped before the last row, else NaN. */
  readonly ends: readonly [number, number];
}

export class March {
  private readonly w: Float64Array;
  private readonly rules: StepRules;
  private readonly nodes: number;
  private readonly times: Float64Array;
  private readonly spacing: Float64Array;
  private readonly weights: number;
  private readonly good: number;
  private readonly live: number;
  private corrections = 0;

  constructor(
    private readonly program: Program,
    private readonly data: SolverData,
  ) {
    this.w = new Float64Array(data.state);
    this.rules = data.rules;
    this.nodes = data.rules.nodes;
    this.times = new Float64Array(this.nodes);
    this.spacing = new Float64Array(this.nodes);
    this.weights = (this.nodes + 1) * data.size;
    this.good = this.weights + 2 * this.nodes;
    this.live = this.good + 2;
  }

  /** Solve all rows with other numbers. */
  solve(numbers: ArrayLike<number>, rows: Float64Array): Found {
    const { data } = this;
    const count = rows.length;
    const d = new Float64Array(data.design);
    const found = {
      fits: false,
      begun: false,
      d,
      t: new Float64Array(count).fill(NaN),
      v: new Float64Array(count * data.unknowns).fill(NaN),
      radius: new Float64Array(count).fill(NaN),
      steps: new Float64Array(count),
      ends: [NaN, NaN] as [number, number],
    };
    this.program.design(numbers, d);
    found.fits = d[0] === 1 && d.every(Number.isFinite);
    if (!found.fits) return found;
    const node = this.begin(d);
    found.begun = node !== null;
    if (!node) return found;
    this.bothWays(d, node, rows, 0, found);
    if (data.turn && found.t.some(Number.isNaN)) {
      // 2π and the sum are rounded
      for (const place of data.spread) d[place]! += data.apart;
      for (const turns of [-1, 1]) this.bothWays(d, node, rows, turns * data.turn, found);
    }
    return found;
  }

  private bothWays(d: Float64Array, node: Float64Array, rows: Float64Array, away: number, found: Found): void {
    for (const way of [0, 1] as const) this.follow(d, node, rows, away, way, found);
  }

  private load(d: Float64Array, node: Float64Array): void {
    const { w, data } = this;
    const first = this.live + data.blocks;
    w.set(d.subarray(data.unknowns + 2, data.unknowns + 2 + data.coefficients), first);
    w.set(data.options, first + data.coefficients);
    for (let role = 0; role <= this.nodes; role++) w.set(node, role * data.size);
  }

  /** From the sketch to a proved position, or null. */
  private begin(d: Float64Array): Float64Array | null {
    const { w, data, program } = this;
    const guess = new Float64Array(data.size);
    guess.set(d.subarray(1, data.unknowns + 1));
    guess[data.size - 1] = d[data.unknowns + 1]!;
    this.load(d, guess);
    w.fill(0, this.weights, this.weights + 2 * this.nodes);
    w[this.weights] = 1;
    w[this.good] = 1;
    program.reach(w);
    program.given(w);
    program.damped.forEach((damped, block) => {
      w[this.live + block] = 1;
      this.whileLive(damped, block, this.rules.start_steps);
    });
    for (let again = 0; again < 2; again++) {
      w.copyWithin(data.size, 0, data.size);
      this.judge();
    }
    const node = w.slice(0, data.size);
    const live = w.subarray(this.live, this.live + data.blocks);
    return w[this.good]! > 0.5 && live.every((one) => one === 0) && node.every(Number.isFinite) ? node : null;
  }

  /** How many steps were made. */
  private whileLive(section: Section, block: number, most: number): number {
    let k = 0;
    for (; k < most && this.w[this.live + block] !== 0; k++) section(this.w);
    return k;
  }

  private correct(): void {
    const { w, program } = this;
    this.corrections = 0;
    for (let block = 0; block < program.begin.length; block++) {
      program.begin[block]!(w);
      const more = this.whileLive(program.iterate[block]!, block, this.rules.newton_steps - 1);
      this.corrections = Math.max(this.corrections, 1 + more);
    }
  }

  private judge(): void {
    const { w, program } = this;
    for (const prove of program.prove) prove(w);
    program.agree(w);
  }

  /** Follow the mechanism from row to row, upwards (1) or downwards (0). */
  private follow(
    d: Float64Array,
    node: Float64Array,
    rows: Float64Array,
    away: number,
    way: 0 | 1,
    found: Found,
  ): void {
    const { w, times, program } = this;
    const { size, steps } = this.data;
    this.load(d, node);
    this.spacing.fill(Infinity);
    let row = firstRow(rows, away, w[size - 1]!, way);
    let known = 1;
    let h = steps[0]!;
    while (row >= 0 && row < rows.length) {
      const goal = rows[row]! + away;
      const before = w[2 * size - 1]!;
      const rest = goal - before;
      const step = Math.abs(rest) <= h ? rest : rest < 0 ? -h : h;
      const t = Math.abs(rest) <= h ? goal : before + step;
      for (let k = 0; k < this.nodes; k++) times[k] = w[(k + 2) * size - 1]!;
      this.choose(step, known);
      w[size - 1] = t;
      program.reach(w);
      program.given(w);
      this.correct();
      this.judge();
      const moved = Math.abs(t - before);
      if (w[this.good]! > 0.5 && (t !== before || t === goal)) {
        if (t === goal) {
          this.note(row, found);
          row += 2 * way - 1;
        }
        if (moved >= this.rules.nearly_full * h) h = Math.min(this.rules.growth * h, steps[1]!);
        known = Math.min(known + 1, this.nodes);
        if (moved === 0) known = 1;
        else w.copyWithin(size, 0, this.nodes * size);
      } else {
        h = this.rules.half * moved;
        if (h < steps[2]!) {
          (found.ends as [number, number])[way] = before;
          return;
        }
      }
    }
  }

  /** Store the position of a row; straight ahead comes before whole turns around. */
  private note(row: number, found: Found): void {
    if (!Number.isNaN(found.t[row]!)) return;
    const { unknowns, size } = this.data;
    found.t[row] = this.w[size - 1]!;
    found.v.set(this.w.subarray(0, unknowns), row * unknowns);
    found.radius[row] = this.w[this.good + 1]!;
    found.steps[row] = this.corrections;
  }

  /** The weights of the prediction, computed anew where the spacing has changed. */
  private choose(step: number, known: number): void {
    const { times, spacing } = this;
    const near = this.rules.same * Math.abs(step);
    let same = Math.abs(step - spacing[0]!) <= near;
    for (let k = 1; k < this.nodes; k++) {
      if (!(Math.abs(times[k - 1]! - times[k]! - spacing[k]!) <= near)) same = false;
    }
    if (same) return;
    spacing[0] = step;
    for (let k = 1; k < this.nodes; k++) spacing[k] = times[k - 1]! - times[k]!;
    this.weigh(times[0]! + step, known);
  }

  /** How many of the known last nodes predict well at t. */
  private trusted(t: number, known: number): number {
    const { times, nodes } = this;
    const step = Math.abs(t - times[0]!);
    let used = Math.min(known, nodes);
    for (let k = nodes - 1; k > 0; k--) {
      if (used > k && step > this.rules.far * Math.abs(times[k - 1]! - times[k]!)) used = k;
    }
    return used;
  }

  private weigh(t: number, known: number): void {
    const { times, w } = this;
    const used = this.trusted(t, known);
    for (let i = 0; i < this.nodes; i++) {
      let value = 0;
      let slope = 0;
      if (i < used) {
        let basis = 1;
        let sum = 0;
        for (let j = 0; j < used; j++) {
          if (j === i) continue;
          basis *= (t - times[j]!) / (times[i]! - times[j]!);
          sum += 1 / (times[i]! - times[j]!);
        }
        const square = basis * basis;
        value = (1 - 2 * sum * (t - times[i]!)) * square;
        slope = (t - times[i]!) * square;
      }
      w[this.weights + 2 * i] = value;
      w[this.weights + 2 * i + 1] = slope;
    }
  }
}

/** The first row ahead of t, or at t where the way leads upwards. */
function firstRow(rows: Float64Array, away: number, t: number, way: 0 | 1): number {
  let low = 0;
  while (low < rows.length && rows[low]! + away < t) low++;
  return way === 1 ? low : low - 1;
}
