// The drawing in words: input, status, what moves and where the points are.

import type { MotionView } from "./motion";
import { measured, shortNumber, trimmed } from "./numbers";
import type { Hidden } from "./questions";
import { html } from "./svg";

/** Derivatives that count as 0. */
const STILL = 1e-9;

let made = 0;

export class InWords {
  readonly element: HTMLDetailsElement;
  private readonly text: HTMLElement;

  /** `describe` writes the words; it is called when they are opened. */
  constructor(parent: Element, drawing: Element, describe: () => void) {
    this.element = html("details", { class: "lw-words", id: `lw-words-${++made}` }, parent);
    html("summary", {}, this.element, "In words");
    this.text = html("div", {}, this.element);
    drawing.setAttribute("aria-details", this.element.id);
    this.element.addEventListener("toggle", describe);
  }

  /** Describe a row, if the words are open. */
  show(title: string, view: MotionView, row: number, playing: boolean, hides: (what: Hidden) => boolean): void {
    if (!this.element.open) return;
    this.text.replaceChildren();
    html("p", {}, this.text, wholeOf(title, view, row, playing, hides));
    if (hides("numbers")) {
      html("p", {}, this.text, "The numbers are hidden until the questions are answered.");
      return;
    }
    const turning = linksOf(view, row);
    if (turning.length) this.list("Links", turning);
    this.list("Points", pointsOf(view, row));
  }

  private list(name: string, lines: readonly string[]): void {
    html("h2", {}, this.text, name);
    const list = html("ul", {}, this.text);
    for (const line of lines) html("li", {}, list, line);
  }
}

function wholeOf(title: string, view: MotionView, row: number, playing: boolean, hides: (what: Hidden) => boolean): string {
  const { input, data } = view;
  const driven = data.driven.length ? `, driven at ${data.driven.join(" and ")}` : "";
  const where = hides("input") ? "" : input.name ? `${input.shown} = ${measured(input.values[row]!, input.unit)}${driven}` : "a sketch without a motion";
  const status = data.evidence.status_texts[view.status[row]!] ?? "";
  const proof = view.certified[row] === 1 ? "proved" : "";
  const limit = hides("limits") ? "" : data.limits.find((one) => one.row === row)?.text ?? "";
  const play = input.name ? (playing ? "the motion plays" : "the motion stands still") : "";
  return `${title}: ${[where, [status, proof].filter(Boolean).join(", "), limit, play].filter(Boolean).join("; ")}.`;
}

function linksOf(view: MotionView, row: number): string[] {
  return view.data.turns.flatMap(({ name }, k) => {
    const angle = view.turns[k]?.[row];
    if (!name || angle === undefined || !Number.isFinite(angle)) return [];
    const rate = view.series.find((one) => one.name === name)?.first?.[row];
    const at = `${name} at ${trimmed(shortNumber((angle * 180) / Math.PI, 4))}°`;
    if (name === view.input.name) return [`${at}: the input`];
    if (rate === undefined || !Number.isFinite(rate)) return [at];
    const sense = Math.abs(rate) < STILL ? "at rest" : rate > 0 ? "turning counter-clockwise" : "turning clockwise";
    return [`${at}, ${sense} while ${view.input.shown} grows`];
  });
}

function pointsOf(view: MotionView, row: number): string[] {
  const number = (value: number): string => trimmed(shortNumber(value, 4, 1e-9));
  return view.points.map(({ shown, x, y, moving }) => `${shown} at ${number(x[row]!)}, ${number(y[row]!)}${moving ? "" : ", fixed"}`);
}
