// Buttons and keys that zoom the drawing.

import type { Command } from "../../keys";
import type { Mounted } from "../../mount";
import { html } from "../../svg";

const STEP = 1.25;

export class Zoom {
  readonly element = html("div", { class: "lw-zoom", role: "group", "aria-label": "View" });
  private page: Mounted | null = null;

  constructor() {
    for (const [text, name, keys, act] of [
      ["+", "Zoom in", "+", () => this.by(STEP)],
      ["−", "Zoom out", "-", () => this.by(1 / STEP)],
      ["⤢", "See the whole mechanism", "0", () => this.whole()],
    ] as const) {
      const button = html("button", { type: "button", title: `${name} (${keys})`, "aria-label": name, "aria-keyshortcuts": keys }, this.element, text);
      button.addEventListener("click", act);
    }
  }

  attach(page: Mounted): void {
    this.page = page;
    page.places.canvas.append(this.element);
  }

  readonly commands: readonly Command[] = [
    { keys: ["+", "="], does: "Zoom in", act: () => this.by(STEP) },
    { keys: ["-"], does: "Zoom out", act: () => this.by(1 / STEP) },
    { keys: ["0"], does: "See the whole mechanism", act: () => this.whole() },
  ];

  private by(factor: number): void {
    const { drawing } = this.page!.places;
    const { x, y } = drawing.window;
    drawing.zoom(factor, [x, y]);
  }

  private whole(): void {
    this.page!.places.drawing.see(null);
  }
}
