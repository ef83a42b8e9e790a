// The sign of work: a bar at the top while an answer takes long, with its progress where known.

import { html, put } from "../svg";

/** An answer that takes longer is announced [ms]. */
export const SOON = 300;

export class Busy {
  readonly element = html("div", { class: "lw-busy", role: "progressbar", "aria-label": "Computing", hidden: "" });
  private waiting = new Set<number>();
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** A request was sent. */
  asked(id: number): void {
    this.count(this.waiting.add(id));
    this.timer ??= setTimeout(() => this.show(), SOON);
  }

  /** A request was answered; so were all before it, since they are answered in order. */
  answered(id: number | null): void {
    if (id === null) return;
    this.count(new Set([...this.waiting].filter((one) => one > id)));
    if (this.waiting.size) return;
    this.stop();
  }

  /** The finished fraction of the answer. */
  progress(fraction: number): void {
    put(this.element, { "aria-valuenow": Math.round(100 * fraction) });
    this.element.style.setProperty("--done", `${100 * fraction}%`);
    this.element.classList.add("lw-measured");
  }

  /** Nothing is answered any more. */
  stop(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    this.count(new Set());
    this.element.hidden = true;
    this.element.classList.remove("lw-measured");
    this.element.removeAttribute("aria-valuenow");
  }

  /** Programs that steer the page read the number of open requests. */
  private count(waiting: Set<number>): void {
    this.waiting = waiting;
    put(this.element, { "data-open": waiting.size });
  }

  private show(): void {
    this.element.hidden = false;
  }
}
