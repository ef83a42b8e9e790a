// The displayed row, and its change over time.

export type Listener = (player: Player) => void;

/** Duration of a motion at speed 1 [s]; a long circuit takes longer. */
export function lasting(rows: number): number {
  return Math.min(18, Math.max(2.5, rows / 60));
}

/** How long the last row of a motion in time is shown before it starts again [s]. */
export const REST = 1;

/** A position on a path of `count` rows; plays around a closed path, back and forth on an open one.
 * A motion in time plays in its own time, and starts again at its end. */
export class Player {
  playing = false;
  speed = 1;
  /** The index of the row with its fraction passed; in time, the seconds passed since the first. */
  private place = 0;
  private index = 0;
  private times: Float64Array | null = null;
  private sense = 1;
  private listeners: Listener[] = [];

  constructor(
    private count: number,
    private closed: boolean,
  ) {}

  /** Whether it plays an open path backwards. */
  get back(): boolean {
    return this.playing && this.sense < 0;
  }

  /** Index of the row in the order of the motion. */
  get at(): number {
    return this.times ? this.index : Math.min(this.count - 1, Math.floor(this.place));
  }

  onChange(listener: Listener): void {
    this.listeners.push(listener);
  }

  /** Show another motion, from one of its rows; `times` of its rows [s], if it is in time. */
  restart(count: number, closed: boolean, at: number, times: Float64Array | null = null): void {
    this.count = count;
    this.closed = closed;
    this.sense = 1;
    this.times = times;
    this.go(Math.min(Math.max(at, 0), count - 1));
  }

  go(at: number): void {
    if (this.times) {
      this.index = Math.min(Math.max(at, 0), this.count - 1);
      this.place = this.times[this.index]! - this.times[0]!;
      this.tell();
      return;
    }
    this.place = this.closed ? remainder(at, this.count) : Math.min(Math.max(at, 0), this.count - 1);
    this.tell();
  }

  step(by: number): void {
    this.playing = false;
    this.go(this.at + by);
  }

  play(on: boolean): void {
    this.playing = on && this.count > 1;
    this.tell();
  }

  /** Advance the time [s]; listeners are called if another row is reached. */
  advance(seconds: number, told = true): void {
    if (!this.playing) return;
    const before = this.at;
    if (this.times) {
      this.pass(this.times, this.speed * seconds);
      if (told && this.at !== before) this.tell();
      return;
    }
    const way = (this.sense * this.speed * seconds * this.count) / lasting(this.count);
    let place = this.place + way;
    if (this.closed) {
      place = remainder(place, this.count);
    } else {
      const last = this.count - 1e-6;
      if (place > last || place < 0) this.sense = -this.sense;
      place = Math.min(Math.max(place, 0), last);
    }
    this.place = place;
    if (told && this.at !== before) this.tell();
  }

  /** Let some of the motion's own time pass. */
  private pass(times: Float64Array, seconds: number): void {
    const lasts = times[this.count - 1]! - times[0]!;
    this.place += seconds;
    if (this.place > lasts + REST * this.speed) [this.place, this.index] = [0, 0];
    while (this.index < this.count - 1 && times[this.index + 1]! - times[0]! <= this.place) this.index += 1;
  }

  private tell(): void {
    for (const listener of this.listeners) listener(this);
  }
}

function remainder(number: number, count: number): number {
  return ((number % count) + count) % count;
}
