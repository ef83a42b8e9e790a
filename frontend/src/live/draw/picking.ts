// Picking what a part needs: one thing or place after the other, each with its prompt.

import type { PalettePart, Pick, Picked } from "../../messages";
import { shortNumber, trimmed } from "../../numbers";
import { distance, type Anchor, type Place } from "./geometry";

const short = (value: number): string => trimmed(shortNumber(value, 4));

export class Picking {
  private readonly picks: Picked[] = [];

  constructor(
    private readonly part: PalettePart,
    private readonly done: (table: string, picks: readonly Picked[]) => void,
  ) {}

  /** What is picked next. */
  get next(): Pick {
    const { picks } = this.part;
    return picks[Math.min(this.picks.length, picks.length - 1)]!;
  }

  /** What to do now, in one line. */
  get prompt(): string {
    const { picks, title } = this.part;
    const step = picks.length > 1 ? ` ${Math.min(this.picks.length + 1, picks.length)} of ${picks.length}` : "";
    return `${title}${step}: ${this.next.prompt}${this.picks.length ? " Escape begins again." : ""}`;
  }

  get begun(): boolean {
    return this.picks.length > 0;
  }

  /** Places that were picked. */
  get places(): Place[] {
    return this.picks.map(({ x, y }) => [x, y] as const);
  }

  /** The place from which a line goes on. */
  get from(): Place | undefined {
    return this.places[this.picks.length - 1];
  }

  /** The thing that would be picked; null: nothing here that could be. */
  taken({ at, point, link }: Anchor): Anchor | null {
    const { takes } = this.next;
    if (point !== undefined && takes.includes("point")) return { at, point };
    if (link !== undefined && takes.includes("link")) return { at, link };
    return takes.includes("place") ? { at } : null;
  }

  /** Pick by a click, or by a drag from one anchor to another; whether that was possible. */
  pick(start: Anchor, end: Anchor | null): boolean {
    const { sized } = this.next;
    const size = end && sized ? distance(start.at, end.at) : 0;
    if (!this.add(start, size)) return false;
    return end === null || sized || !this.begun || this.add(end, 0);
  }

  private add(anchor: Anchor, size: number): boolean {
    const { repeated } = this.next;
    const found = this.taken(anchor);
    if (found === null) return false;
    const before = this.from;
    if (repeated && before && this.picks.length > 1 && distance(before, found.at) === 0) {
      this.finish();
      return true;
    }
    const [x, y] = found.at;
    this.picks.push({ x, y, point: found.point ?? "", link: found.link ?? "", size });
    if (!repeated && this.picks.length === this.part.picks.length) this.finish();
    return true;
  }

  /** End repeated picks; whether there were enough. */
  finish(): boolean {
    if (this.picks.length < this.part.picks.length) return false;
    const picks = this.picks.splice(0);
    this.done(this.part.table, picks);
    return true;
  }

  cancel(): void {
    this.picks.length = 0;
  }

  /** The size of what is being dragged: a radius, or a length. */
  told(start: Place, end: Place, unit: string): string {
    const away = `${short(distance(start, end))} ${unit}`.trim();
    return this.next.sized ? `radius ${away}` : away;
  }
}
