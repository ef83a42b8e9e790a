// The chosen design in motion, with the numbered positions that it passes.

import type { DesignFound } from "../messages";
import { Player } from "../player";
import { html, put, say, svg } from "../svg";

const PLAY = "M7 4.5v15l12.5-7.5z";
const PAUSE = "M6.5 5h4v14h-4zM13.5 5h4v14h-4z";
/** So near to a position [rows] it is shown as reached. */
const REACHED = 0.75;
/** Positions with a button each. */
const MOST = 12;

export class PositionPlayer {
  readonly element = html("div", { class: "lw-transport", role: "group", "aria-label": "Motion" });
  private readonly button = html("button", { type: "button", class: "lw-play" }, this.element);
  private readonly icon = svg("path", {}, svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, this.button));
  private readonly chips = html("div", { class: "lw-t-chips", role: "group", "aria-label": "Positions" }, this.element);
  private readonly bar = html("input", { type: "range", min: 0, step: 1, "aria-label": "Position of the motion" }, html("div", { class: "lw-track" }, this.element));
  private readonly player = new Player(1, false);
  private design: DesignFound | null = null;
  private last = 0;

  constructor(private readonly stand: (row: readonly number[] | null, at: number | null) => void) {
    this.button.addEventListener("click", () => this.player.play(!this.player.playing));
    this.bar.addEventListener("input", () => this.hold(Number(this.bar.value)));
    this.player.onChange(() => this.draw());
    const tick = (now: number): void => {
      this.player.advance(Math.min(0.1, Math.max(0, now - this.last) / 1000));
      this.last = now;
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /** Another design, at the same share of its motion; while one is dragged the motion goes on. */
  show(design: DesignFound | null, live = false): void {
    const share = this.design ? this.player.at / Math.max(1, this.rows.length - 1) : 0;
    const playing = this.player.playing;
    this.design = design;
    this.element.hidden = !this.rows.length;
    if (!this.rows.length || !design) {
      this.player.playing = false;
      this.stand(null, null);
      return;
    }
    put(this.bar, { max: this.rows.length - 1 });
    this.makeChips(this.marks.length);
    const start = this.player.at === 0 && !live ? (this.marks[0] ?? 0) : share * (this.rows.length - 1);
    this.player.restart(this.rows.length, closes(design), Math.round(start));
    this.player.playing = playing && this.rows.length > 1;
    this.draw();
  }

  play(on?: boolean): void {
    this.player.play(on ?? !this.player.playing);
  }

  /** Go to a position by its place in the list. */
  goTo(position: number): void {
    const mark = this.marks[position];
    if (mark !== undefined) this.hold(Math.round(mark), position);
  }

  /** Go to the next position, or the one before. */
  step(by: number): void {
    const { marks } = this;
    if (!marks.length) return;
    const at = this.player.at;
    const order = marks.map((mark, k) => ({ mark: Math.round(mark), k })).sort((one, other) => one.mark - other.mark);
    const next = by > 0 ? order.find(({ mark }) => mark > at) ?? order[0]! : [...order].reverse().find(({ mark }) => mark < at) ?? order.at(-1)!;
    this.goTo(next.k);
  }

  private get rows(): readonly (readonly number[])[] {
    return this.design ? (this.design.rows.length ? this.design.rows : this.design.at) : [];
  }

  private get marks(): readonly number[] {
    return this.design ? (this.design.rows.length ? this.design.marks : this.design.at.map((_, k) => k)) : [];
  }

  private hold(row: number, position: number | null = null): void {
    this.player.playing = false;
    this.player.go(row);
    if (position !== null) this.draw(position);
  }

  private draw(exact: number | null = null): void {
    const { design, player } = this;
    const state = player.playing ? "playing" : "paused";
    if (this.button.dataset.state !== state) {
      this.button.dataset.state = state;
      put(this.button, { "aria-label": player.playing ? "Pause" : "Play", title: `${player.playing ? "Pause" : "Play"} (space)` });
      put(this.icon, { d: player.playing ? PAUSE : PLAY });
    }
    if (!design || !this.rows.length) return;
    const near = exact ?? nearest(this.marks, player.at);
    this.bar.value = String(player.at);
    put(this.bar, { "aria-valuetext": near === null ? `${player.at + 1} of ${this.rows.length}` : `position ${near + 1}` });
    [...this.chips.children].forEach((chip, k) => chip.setAttribute("aria-pressed", String(k === near)));
    this.stand((near === null ? null : design.at[near]) ?? this.rows[player.at] ?? null, near);
  }

  private makeChips(count: number): void {
    const shown = count <= MOST ? count : 0;
    if (this.chips.children.length === shown) return; // they are the same
    this.chips.replaceChildren();
    for (let k = 0; k < shown; k++) {
      const chip = html("button", { type: "button", "aria-label": `Position ${k + 1}`, title: `Position ${k + 1} (${k + 1})` }, this.chips);
      say(chip, String(k + 1));
      chip.addEventListener("click", () => this.goTo(k));
    }
  }
}

/** The position that a row reaches. */
function nearest(marks: readonly number[], at: number): number | null {
  const best = marks.reduce((found, mark, k) => (found < 0 || Math.abs(mark - at) < Math.abs(marks[found]! - at) ? k : found), -1);
  return best >= 0 && Math.abs(marks[best]! - at) < REACHED ? best : null;
}

/** Whether a motion ends where it begins. */
function closes({ rows }: DesignFound): boolean {
  const [first, last] = [rows[0], rows.at(-1)];
  if (!first || !last || rows.length < 3) return false;
  const size = Math.max(...first.map((value, k) => Math.abs(value - rows[rows.length >> 1]![k]!)));
  return first.every((value, k) => Math.abs(value - last[k]!) < 1e-6 * size);
}
