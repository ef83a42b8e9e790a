// Arrows of inputs, which are reversed in place while the input decreases.

import type { Part } from "./page_data";

/** The coefficients of an affine map, as in SVG and on a canvas. */
export type Affine = [number, number, number, number, number, number];

/** Whether a shape is the arrow of an input. */
export function isArrow(part: Part): boolean {
  return part.role === "input" && part.head.length > 0;
}

/** The map that reverses an arrow, straight or circular; `up` is 1 where y points upwards, else -1. */
export function reversal(shaft: readonly number[], head: readonly number[], up: 1 | -1): Affine {
  const [x0, y0, x1, y1] = [shaft[0]!, up * shaft[1]!, head[0]!, up * head[1]!];
  const length = Math.hypot(x1 - x0, y1 - y0) || 1;
  const [u, v] = [(x1 - x0) / length, (y1 - y0) / length];
  const far = u * (x0 + x1) + v * (y0 + y1);
  return [1 - 2 * u * u, -2 * u * v, -2 * u * v, 1 - 2 * v * v, far * u, far * v];
}
