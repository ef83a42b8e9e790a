// One request at a time; of those that wait only the latest, as of a slider that is being dragged.

/** Seconds after which a request that nobody answered counts as answered. */
export const PATIENCE = 1.5;

export class Latest<T> {
  private busy = false;
  private waiting: T | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly send: (request: T) => void) {}

  /** Send it, at once or when what is under way has been answered. */
  put(request: T): void {
    if (this.busy) this.waiting = request;
    else this.start(request);
  }

  /** What is under way has been answered. */
  answered(): void {
    clearTimeout(this.timer);
    this.busy = false;
    const next = this.waiting;
    this.waiting = null;
    if (next !== null) this.start(next);
  }

  /** Nothing that waits is of interest any more. */
  clear(): void {
    this.waiting = null;
  }

  private start(request: T): void {
    this.busy = true;
    this.timer = setTimeout(() => this.answered(), 1000 * PATIENCE);
    this.send(request);
  }
}
