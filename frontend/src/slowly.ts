// Limits the rate of an action, with a final call at the end of a run.

export class Slowly {
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly every: number,
    private readonly act: () => void,
  ) {}

  /** Schedule the action; all calls until then are merged. */
  soon(): void {
    if (this.timer) return;
    this.timer = setTimeout(() => {
      this.timer = undefined;
      this.act();
    }, this.every);
  }

  /** Run a scheduled action now, and stop. */
  stop(): void {
    if (!this.timer) return;
    clearTimeout(this.timer);
    this.timer = undefined;
    this.act();
  }
}
