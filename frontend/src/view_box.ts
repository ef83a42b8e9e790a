// The visible part of the plane, chosen by zooming and panning.

/** A view: its centre and width in the unit of the plane. */
export interface View {
  readonly x: number;
  readonly y: number;
  readonly width: number;
}

/** The view that contains a box (left, bottom, right, top) in a window of w by h pixels. */
export function viewOf([left, bottom, right, top]: readonly number[], w: number, h: number): View {
  const width = Math.max(right! - left!, ((top! - bottom!) * w) / Math.max(h, 1));
  return { x: (left! + right!) / 2, y: (bottom! + top!) / 2, width: width || 1 };
}

/** Left, bottom, right, top of a view in a window of w by h pixels. */
export function boxOf({ x, y, width }: View, w: number, h: number): [number, number, number, number] {
  const height = (width * h) / Math.max(w, 1);
  return [x - width / 2, y - height / 2, x + width / 2, y + height / 2];
}

/** Zoom by a factor; the point (x, y) keeps its place on the screen. */
export function zoomed(view: View, factor: number, [x, y]: readonly [number, number]): View {
  const width = Math.min(1e12, Math.max(1e-12, view.width / factor));
  const share = width / view.width;
  return { x: x + (view.x - x) * share, y: y + (view.y - y) * share, width };
}

/** How much wider than high a view may be before its height decides the size of symbols. */
const WIDEST = 4 / 3;

/** The width of a view, or what its height allows: the view that fits symbols of this size is smaller. */
export function symbolWidth({ width }: View, w: number, h: number): number {
  return Math.min(width, (WIDEST * width * h) / Math.max(w, 1));
}
