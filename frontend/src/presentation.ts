// The page for a room: a large drawing with equations and numbers beside it.

import { declareKeys, type Command } from "./keys";
import { html, svg } from "./svg";

export class Presentation {
  readonly button: HTMLButtonElement;
  on = false;
  /** Called after it has begun or ended. */
  changed: (on: boolean) => void = () => {};
  private filled = false;
  private more: readonly Command[] = [];

  constructor(
    private readonly root: HTMLElement,
    head: Element,
    signal: AbortSignal,
  ) {
    this.button = html("button", { type: "button", class: "lw-present", "aria-pressed": "false", "aria-label": "Present", title: "Present: large drawing and equations (F9)" }, head);
    svg("path", { d: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5" }, svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, this.button));
    this.button.addEventListener("click", () => this.set(!this.on));
    document.addEventListener("fullscreenchange", () => this.screen(), { signal });
    declareKeys("Presentation", this.commands);
  }

  /** Keys that have a meaning only here. */
  also(commands: readonly Command[]): void {
    this.more = commands.map((one) => ({ ...one, when: () => this.on && (one.when?.() ?? true) }));
    declareKeys("Presentation", this.commands);
  }

  get commands(): readonly Command[] {
    return [
      { keys: ["F9"], does: "Begin or end the presentation", act: () => this.set(!this.on) },
      { keys: ["Escape"], does: "End the presentation", when: () => this.on, act: () => this.set(false) },
      ...this.more,
    ];
  }

  set(on: boolean): void {
    if (on === this.on) return;
    this.on = on;
    this.root.classList.toggle("lw-presenting", on);
    this.button.setAttribute("aria-pressed", String(on));
    if (on) this.root.requestFullscreen?.().catch(() => {}); // as where a frame forbids it
    else if (document.fullscreenElement === this.root) void document.exitFullscreen();
    this.changed(on);
  }

  /** The Escape key of a full screen is the browser's. */
  private screen(): void {
    const full = document.fullscreenElement === this.root;
    if (this.filled && !full) this.set(false);
    this.filled = full;
  }
}
