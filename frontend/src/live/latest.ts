// Limits pending requests; of waiting ones only the latest is sent, as for a dragged slider.

/** Timeout of requests without answer [s]. */
export const PATIENCE = 1.5;

/** Maximum pending requests: one is computed while the answer to the other is displayed. */
export const UNDER_WAY = 2;

export class Latest<T> {
  private under: number[] = [];
  private waiting: T | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** `send` returns the id repeated by the answer. */
  constructor(private readonly send: (request: T) => number) {}

  /** Send a request, immediately or after pending ones are answered. */
  put(request: T): void {
    if (this.under.length >= UNDER_WAY) this.waiting = request;
    else this.start(request);
  }

  /** Mark this request and all earlier ones as answered; ids of other kinds are ignored. */
  answered(number: number | null): void {
    if (number === null || !this.under.includes(number)) return;
    this.under = this.under.filter((one) => one > number);
    this.next();
  }

  /** Drop all waiting requests. */
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
