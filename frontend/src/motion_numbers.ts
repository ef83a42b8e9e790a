// The numbers of the whole motion: strokes, time ratios, lengths of paths.

import type { MotionView } from "./motion";
import { measured } from "./numbers";
import { html, say } from "./svg";

export class MotionNumbers {
  private readonly box: HTMLDetailsElement;
  private readonly list: HTMLElement;
  private made = "";

  constructor(parent: Element) {
    this.box = html("details", { class: "lw-motion-numbers", open: "", hidden: "" }, parent);
    html("summary", {}, this.box, "Whole motion");
    this.list = html("dl", { class: "lw-proof" }, this.box);
  }

  /** Show the numbers of a motion; during a drag (`steady`) there are none, and those before stay. */
  show(view: MotionView, steady: boolean): void {
    const { numbers } = view.data;
    this.box.classList.toggle("lw-stale", steady);
    if (!numbers.length && steady) return;
    this.box.hidden = !numbers.length;
    const names = numbers.map((one) => one.name).join("\n");
    if (names !== this.made) {
      this.made = names;
      this.list.replaceChildren();
      for (const { shown, name } of numbers) {
        html("dt", {}, this.list, shown);
        html("dd", { "data-fact": name }, this.list);
      }
    }
    numbers.forEach(({ value, unit }, k) => {
      const text = value === null ? "–" : measured(Number(value.toPrecision(6)), unit);
      say(this.list.querySelectorAll("dd")[k]!, text);
    });
  }
}
