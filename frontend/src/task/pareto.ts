// Transmission angle against size: what a larger mechanism gains.

import type { DesignShown, TaskState } from "../messages";
import { measured, roundedDown, shortNumber, ticks, trimmed } from "../numbers";
import { html, say, svg } from "../svg";
import { called } from "./designs_table";
import { front, type Place } from "./geometry";

const [WIDTH, HEIGHT] = [400, 290];
const [LEFT, RIGHT, TOP, BOTTOM] = [44, 14, 12, 40];
/** Sizes that differ by more are on a logarithmic axis. */
const WIDE = 8;
/** Relative: sizes that differ by less are one. */
const ONE_SIZE = 1e-3;

export class Pareto {
  readonly element = html("div", { class: "lw-t-pareto" });
  private readonly lead = html("p", { class: "lw-lead" }, this.element);
  private readonly plot = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "group", "aria-label": "Transmission angle against size" }, this.element);
  private chosen = -1;

  constructor(private readonly choose: (index: number) => void) {}

  show(task: TaskState, listed: readonly DesignShown[]): void {
    this.plot.replaceChildren();
    const designs = listed.filter(({ sound, size, transmission }) => sound && size !== null && transmission !== null);
    const sizes = designs.map(({ size }) => size!);
    const [low, high] = [Math.min(...sizes), Math.max(...sizes)];
    const one = high - low <= ONE_SIZE * high;
    this.element.classList.toggle("lw-t-none", !designs.length || one);
    if (!designs.length) say(this.lead, "Sound designs are shown here, once there are any.");
    else if (one) say(this.lead, `All sound designs have one size, ${trimmed(shortNumber(high, 4))} ${task.length_unit}: there is nothing to trade for it.`);
    else say(this.lead, "Sound designs. On the line, no other one is both smaller and better; choose one by a click or with Tab and Enter.");
    if (!designs.length || one) return;
    const logs = high > WIDE * low;
    const along = (size: number): number => (logs ? Math.log10(size) : size);
    const [from, to] = [along(low), along(high)];
    const span = to - from;
    const x = (size: number): number => LEFT + 8 + ((along(size) - from) / span) * (WIDTH - LEFT - RIGHT - 16);
    const right = task.angle_unit === "deg" ? 90 : Math.PI / 2;
    const top = Math.min(right, 1.08 * Math.max(...designs.map(({ transmission }) => transmission!)));
    const y = (angle: number): number => HEIGHT - BOTTOM - (angle / top) * (HEIGHT - TOP - BOTTOM);
    this.axes(task, { low, high, logs, x }, top, y);
    const places = designs.map(({ size, transmission }): Place => [size!, transmission!]);
    const best = front(places);
    svg("path", { d: stairs(best.map((k): Place => [x(places[k]![0]), y(places[k]![1])])), class: "lw-t-front" }, this.plot);
    const order = [...designs.keys()].filter((k) => !best.includes(k)).concat(best);
    for (const k of order) this.dot(designs[k]!, [x(sizes[k]!), y(designs[k]!.transmission!)], best.includes(k), task);
    this.mark(this.chosen);
  }

  mark(index: number): void {
    this.chosen = index;
    for (const dot of this.plot.querySelectorAll(".lw-t-point")) dot.classList.toggle("lw-t-chosen", Number(dot.getAttribute("data-index")) === index);
  }

  private axes(task: TaskState, sizes: { low: number; high: number; logs: boolean; x: (size: number) => number }, top: number, y: (angle: number) => number): void {
    const marks = sizes.logs ? powers(sizes.low, sizes.high) : ticks(sizes.low, sizes.high, 4);
    for (const size of marks) {
      const at = sizes.x(size);
      svg("path", { d: `M${at} ${TOP}V${HEIGHT - BOTTOM}`, class: "lw-grid" }, this.plot);
      svg("text", { x: at, y: HEIGHT - BOTTOM + 15, "text-anchor": "middle" }, this.plot).textContent = trimmed(shortNumber(size, 4));
    }
    for (const angle of ticks(0, top, 4)) {
      svg("path", { d: `M${LEFT} ${y(angle)}H${WIDTH - RIGHT}`, class: "lw-grid" }, this.plot);
      svg("text", { x: LEFT - 6, y: y(angle) + 4, "text-anchor": "end" }, this.plot).textContent = measured(Number(angle.toPrecision(6)), task.angle_unit === "deg" ? "deg" : "");
    }
    svg("text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 6, "text-anchor": "middle" }, this.plot).textContent = `size [${task.length_unit}]${sizes.logs ? ", logarithmic" : ""}`;
    svg("text", { x: 12, y: (TOP + HEIGHT - BOTTOM) / 2, "text-anchor": "middle", transform: `rotate(-90 12 ${(TOP + HEIGHT - BOTTOM) / 2})` }, this.plot).textContent = "transmission angle, smallest";
  }

  private dot(design: DesignShown, [x, y]: Place, best: boolean, task: TaskState): void {
    const name = `${called(design)}: transmission angle ${measured(roundedDown(design.transmission!, 4), task.angle_unit)}, size ${trimmed(shortNumber(design.size!, 4))} ${task.length_unit}`;
    const dot = svg("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: best ? 5 : 3.5, class: `lw-t-point${best ? " lw-t-best" : ""}`, "data-index": design.index, ...(best ? { tabindex: 0, role: "button", "aria-label": name } : { "aria-hidden": "true" }) }, this.plot);
    svg("title", {}, dot).textContent = name;
    dot.addEventListener("click", () => this.choose(design.index));
    dot.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      event.stopPropagation();
      this.choose(design.index);
    });
  }
}

/** Steps through places: each is the best until the next. */
function stairs(places: readonly Place[]): string {
  return places.map(([x, y], k) => (k ? `H${x.toFixed(1)}V${y.toFixed(1)}` : `M${x.toFixed(1)} ${y.toFixed(1)}`)).join("");
}

/** 1, 2 and 5 times powers of ten between two sizes, few of them. */
function powers(low: number, high: number): number[] {
  const found: number[] = [];
  const wide = high > 200 * low;
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
    for (const part of wide ? [1] : [1, 2, 5]) {
      const size = part * 10 ** power;
      if (size >= low && size <= high) found.push(size);
    }
  }
  return found.length > 1 ? found : [low, high];
}
