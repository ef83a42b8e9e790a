// The displayed row, and its change over time.

export type Listener = (player: Player) => void;

/** Duration of a motion at speed 1 [s]; a long circuit takes longer. */
export function lasting(rows: number): number {
  return Math.min(18, Math.max(2.5, rows / 60));
}

/** A position on a path of `count` rows; plays around a closed path, back and forth on an open one. */
export class Player {
  playing = false;
  speed = 1;
  private place = 0;
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
    return Math.min(this.count - 1, Math.floor(this.place));
  }

  onChange(listener: Listener): void {
    this.listeners.push(listener);
  }

  /** Show another motion, from one of its rows. */
  restart(count: number, closed: boolean, at: number): void {
    this.count = count;
    this.closed = closed;
    this.sense = 1;
    this.place = Math.min(Math.max(at, 0), count - 1);
    this.tell();
  }

  go(at: number): void {
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

  private tell(): void {
    for (const listener of this.listeners) listener(this);
  }
}

function remainder(number: number, count: number): number {
  return ((number % count) + count) % count;
}
