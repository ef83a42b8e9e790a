// Pointers on the drawing that move its view: one that holds nothing, or two fingers.

import type { Drawing } from "../../drawing";
import { distance, type Place } from "./geometry";

export class Touches {
  /** Whether one pointer moves the view. */
  panned = false;
  private readonly at = new Map<number, Place>();

  get count(): number {
    return this.at.size;
  }

  begin(event: PointerEvent): void {
    this.at.set(event.pointerId, [event.clientX, event.clientY]);
  }

  end(event: PointerEvent): void {
    this.at.delete(event.pointerId);
    this.panned = false;
  }

  /** Pan with one pointer that holds nothing, zoom with two; whether that was done. */
  moved(event: PointerEvent, drawing: Drawing): boolean {
    const before = this.at.get(event.pointerId);
    if (!before) return false;
    const now: Place = [event.clientX, event.clientY];
    if (this.at.size === 2) {
      const other = [...this.at].find(([id]) => id !== event.pointerId)![1];
      const centre = drawing.placeAt({ clientX: (now[0] + other[0]) / 2, clientY: (now[1] + other[1]) / 2 });
      drawing.zoom(distance(now, other) / Math.max(1, distance(before, other)), centre);
      drawing.pan((-(now[0] - before[0]) / 2) * drawing.pixel, ((now[1] - before[1]) / 2) * drawing.pixel);
    } else if (this.panned) {
      drawing.pan(-(now[0] - before[0]) * drawing.pixel, (now[1] - before[1]) * drawing.pixel);
    } else return false;
    this.at.set(event.pointerId, now);
    event.stopImmediatePropagation();
    return true;
  }
}

/** Zoom with the wheel, about the pointer. */
export function wheeled(event: WheelEvent, drawing: Drawing): void {
  event.preventDefault();
  drawing.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 30 : 1)), drawing.placeAt(event));
}
