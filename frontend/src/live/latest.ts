// Few requests at a time; of those that wait only the latest, as of a slider that is being dragged.

/** Seconds after which requests that nobody answered count as answered. */
export const PATIENCE = 1.5;

/** Requests under way: one is worked on while the answer to the other is shown. */
export const UNDER_WAY = 2;

export class Latest<T> {
  private under: number[] = [];
  private waiting: T | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** `send` gives the number that the answer repeats. */
  constructor(private readonly send: (request: T) => number) {}

  /** Send it, at once or when what is under way has been answered. */
  put(request: T): void {
    if (this.under.length >= UNDER_WAY) this.waiting = request;
    else this.start(request);
  }

  /** This request and all before it have been answered; others are not of this kind. */
  answered(number: number | null): void {
    if (number === null || !this.under.includes(number)) return;
    this.under = this.under.filter((one) => one > number);
    this.next();
  }

  /** Nothing that waits is of interest any more. */
  clear(): void {
    this.waiting = null;
  }

  private next(): void {
    const next = this.waiting;
    this.waiting = null;
    if (next !== null) this.start(next);
  }

  private start(request: T): void {
    clearTimeout(this.timer);
    this.under.push(this.send(request));
    this.timer = setTimeout(() => {
      this.under = [];
      this.next();
    }, 1000 * PATIENCE);
  }
}
