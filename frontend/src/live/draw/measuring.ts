// Distances and angles between places of the drawing, and the formulas that give them.

import { shortNumber, trimmed } from "../../numbers";
import { distance, type Place } from "./geometry";

/** A place that was clicked; a point moves with the mechanism. */
export interface Mark {
  readonly at: Place;
  readonly point?: string;
}

/** The angle at b from a to c, counter-clockwise [rad]. */
export function angleAt(a: Place, b: Place, c: Place): number {
  const [ux, uy, vx, vy] = [a[0] - b[0], a[1] - b[1], c[0] - b[0], c[1] - b[1]];
  return Math.atan2(ux * vy - uy * vx, ux * vx + uy * vy);
}

/** What is measured between two or three places, in words. */
export function told(marks: readonly Mark[], unit: string, angleUnit: string): string {
  const [a, b, c] = marks.map(({ at }) => at);
  const number = (value: number): string => trimmed(shortNumber(value, 6));
  if (!a || !b) return "";
  const length = `${number(distance(a, b))} ${unit}`.trim();
  const parts = `horizontal ${number(Math.abs(b[0] - a[0]))}, vertical ${number(Math.abs(b[1] - a[1]))}`;
  if (!c) return `${named(marks)}: ${length} (${parts})`;
  const angle = angleAt(a, b, c);
  return `${named(marks)}: ${angleUnit === "rad" ? `${number(angle)} rad` : `${number((angle * 180) / Math.PI)}°`}`;
}

function named(marks: readonly Mark[]): string {
  return marks.every(({ point }) => point) ? marks.map(({ point }) => point).join(" ") : marks.length > 2 ? "Angle" : "Distance";
}

/** The measure as an output of the file; null if a place is not a point. */
export function outputOf(marks: readonly Mark[]): { base: string; formula: string } | null {
  const [a, b, c] = marks.map(({ point }) => point);
  if (!a || !b || (marks.length > 2 && !c)) return null;
  if (!c) return { base: "distance", formula: `hypot(${b}.x - ${a}.x, ${b}.y - ${a}.y)` };
  const [ux, uy, vx, vy] = [`(${a}.x - ${b}.x)`, `(${a}.y - ${b}.y)`, `(${c}.x - ${b}.x)`, `(${c}.y - ${b}.y)`];
  return { base: "angle", formula: `atan2(${ux}*${vy} - ${uy}*${vx}, ${ux}*${vx} + ${uy}*${vy})` };
}
