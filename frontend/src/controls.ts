// Controls: play, scrub, speed, selection of the motion, display options.

import type { MotionView } from "./motion";
import { measured } from "./numbers";
import { html, put, say, svg } from "./svg";

const PLAY = "M7 4.5v15l12.5-7.5z";
const PAUSE = "M6.5 5h4v14h-4zM13.5 5h4v14h-4z";

export interface TransportHooks {
  readonly play: (on: boolean) => void;
  readonly go: (index: number) => void;
  readonly speed: (factor: number) => void;
}

/** The row of buttons under the drawing. */
export class Transport {
  private readonly row: HTMLElement;
  private readonly button: HTMLButtonElement;
  private readonly icon: SVGPathElement;
  private readonly bar: HTMLInputElement;
  private readonly marks: HTMLElement;
  private readonly readout: HTMLOutputElement;
  private times: Float64Array | null = null;

  constructor(parent: Element, hooks: TransportHooks) {
    const row = html("div", { class: "lw-transport", role: "group", "aria-label": "Motion" }, parent);
    this.row = row;
    this.button = html("button", { type: "button", class: "lw-play" }, row);
    this.icon = svg("path", {}, svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, this.button));
    const track = html("div", { class: "lw-track" }, row);
    this.bar = html("input", { type: "range", min: 0, step: 1, "aria-label": "Position of the motion" }, track);
    this.marks = html("div", { class: "lw-marks" }, track);
    this.readout = html("output", { class: "lw-readout" }, row);
    this.speed(row, hooks);
    this.button.addEventListener("click", () => hooks.play(this.button.dataset.state !== "playing"));
    this.bar.addEventListener("input", () => hooks.go(this.index(Number(this.bar.value))));
    this.playing(false);
  }

  show(view: MotionView): void {
    const last = view.order.length - 1;
    this.row.hidden = view.input.name === "";
    // over the time, the bar is in seconds: rows are closer around events
    this.times = view.times;
    const [least, most] = this.times ? [this.times[0]!, this.times[last]!] : [0, last];
    put(this.bar, { min: least, max: most, step: this.times ? "any" : 1 });
    const marks = view.data.limits.map((limit) => ({ at: view.order.indexOf(limit.row), text: limit.text })).filter(({ at }) => at >= 0);
    const wanted = JSON.stringify([least, most, marks]);
    if (wanted === this.marks.dataset.made) return;
    this.marks.dataset.made = wanted;
    this.marks.replaceChildren();
    for (const { at, text } of marks) {
      const mark = html("span", { title: text }, this.marks);
      const place = this.times ? this.times[at]! : at;
      mark.style.left = `${(100 * (place - least)) / (most - least || 1)}%`;
    }
  }

  /** The index of the row at a place of the bar. */
  private index(place: number): number {
    const { times } = this;
    if (!times) return place;
    let best = 0;
    times.forEach((time, k) => {
      if (Math.abs(time - place) < Math.abs(times[best]! - place)) best = k;
    });
    return best;
  }

  draw(view: MotionView, index: number, row: number): void {
    const { input } = view;
    const event = this.times ? view.data.limits.find((one) => one.row === row)?.text : undefined;
    const text = `${input.shown} = ${this.times ? inSeconds(this.times, index) : measured(input.values[row]!, input.unit)}`;
    this.bar.value = String(this.times ? this.times[index] : index);
    const hidden = this.row.closest(".lw-hides-input") !== null;
    put(this.bar, { "aria-valuetext": hidden ? `${index + 1} of ${view.order.length}` : `${text}, ${index + 1} of ${view.order.length}` });
    say(this.readout, event ? `${text} · ${event}` : text);
  }

  playing(on: boolean): void {
    if (this.button.dataset.state === (on ? "playing" : "paused")) return;
    this.button.dataset.state = on ? "playing" : "paused";
    this.button.setAttribute("aria-label", on ? "Pause" : "Play");
    this.button.title = on ? "Pause (space)" : "Play (space)";
    this.icon.setAttribute("d", on ? PAUSE : PLAY);
  }

  private speed(row: Element, hooks: TransportHooks): void {
    const select = html("select", { class: "lw-speed", "aria-label": "Speed" }, row);
    for (const factor of [0.01, 0.1, 0.25, 0.5, 1, 2, 4, 10]) {
      const option = html("option", { value: factor }, select, `${factor}×`);
      option.selected = factor === 1;
    }
    select.addEventListener("change", () => hooks.speed(Number(select.value)));
  }
}

/** A time with as many decimals as tell the rows apart, so that it does not change its width. */
export function inSeconds(times: Float64Array, index: number): string {
  const lasts = times[times.length - 1]! - times[0]!;
  const decimals = Math.min(9, Math.max(2, 3 - Math.floor(Math.log10(lasts || 1))));
  return `${Math.max(0, times[index]!).toFixed(decimals)} s`;
}

/** A switch with its name. */
export function toggle(
  parent: Element,
  name: string,
  on: boolean,
  changed: (on: boolean) => void,
): HTMLInputElement {
  const label = html("label", { class: "lw-toggle" }, parent);
  const box = html("input", { type: "checkbox" }, label);
  box.checked = on;
  label.append(name);
  box.addEventListener("change", () => changed(box.checked));
  return box;
}
