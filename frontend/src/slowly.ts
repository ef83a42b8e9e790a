// Does something at most so often, and at the end of a run once more.

export class Slowly {
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly every: number,
    private readonly act: () => void,
  ) {}

  /** Act before long: all calls until then are one. */
  soon(): void {
    if (this.timer) return;
    this.timer = setTimeout(() => {
      this.timer = undefined;
      this.act();
    }, this.every);
  }

  /** Act now what is still to be done, and no more. */
  stop(): void {
    if (!this.timer) return;
    clearTimeout(this.timer);
    this.timer = undefined;
    this.act();
  }
}
