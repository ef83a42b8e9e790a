// Points and links under the pointer, and places to which the pointer is drawn.

import type { Link } from "../../messages";
import { roundStep } from "../ranges";

export type Place = readonly [number, number];
export type Places = Readonly<Record<string, Place>>;

/** A place in the plane: an existing point, a place on a link, or free. */
export interface Anchor {
  readonly at: Place;
  readonly point?: string;
  readonly link?: string;
  /** Why the pointer was drawn there: `= A B`, `90°`. */
  readonly hint?: string;
}

export interface Sketch {
  readonly points: Places;
  readonly links: readonly Link[];
}

export const distance = ([a, b]: Place, [c, d]: Place): number => Math.hypot(c - a, d - b);

/** The nearest point within reach. */
export function pointAt(sketch: Sketch, at: Place, reach: number, except?: ReadonlySet<string>): string | null {
  let [best, least] = [null as string | null, reach];
  for (const [name, place] of Object.entries(sketch.points)) {
    const away = distance(place, at);
    if (away <= least && !except?.has(name)) [best, least] = [name, away];
  }
  return best;
}

/** The foot of a place on the segment from a to b. */
export function footOn(a: Place, b: Place, at: Place): Place {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const square = dx * dx + dy * dy;
  const share = square ? Math.min(1, Math.max(0, ((at[0] - a[0]) * dx + (at[1] - a[1]) * dy) / square)) : 0;
  return [a[0] + share * dx, a[1] + share * dy];
}

function inside(corners: readonly Place[], [x, y]: Place): boolean {
  let within = false;
  corners.forEach(([x1, y1], k) => {
    const [x2, y2] = corners[(k + 1) % corners.length]!;
    if (y1 > y !== y2 > y && x < x1 + ((y - y1) * (x2 - x1)) / (y2 - y1)) within = !within;
  });
  return within;
}

/** The nearest link within reach, and the place on it; the ground is no link. */
export function linkAt(sketch: Sketch, at: Place, reach: number): { link: string; at: Place } | null {
  let [best, least] = [null as { link: string; at: Place } | null, reach];
  for (const { name, points } of sketch.links) {
    if (name === "ground") continue;
    const corners = points.flatMap((point) => (sketch.points[point] ? [sketch.points[point]!] : []));
    if (corners.length > 2 && inside(corners, at) && least > 0) [best, least] = [{ link: name, at }, 0];
    corners.forEach((corner, k) => {
      const next = corners[k + 1] ?? (corners.length > 2 ? corners[0] : undefined);
      if (!next) return;
      const foot = footOn(corner, next, at);
      const away = distance(foot, at);
      if (away < least) [best, least] = [{ link: name, at: foot }, away];
    });
  }
  return best;
}

export interface Snapping {
  /** Radius of attraction [length]. */
  readonly reach: number;
  /** Spacing of the grid; 0: no grid. */
  readonly grid: number;
  /** The other end of a link that is being drawn. */
  readonly from?: Place;
  /** Points that attract nothing: those being dragged. */
  readonly except?: ReadonlySet<string>;
}

/** The place to which the pointer is drawn: a point, a link, a right angle, an existing length, the grid. */
export function anchorAt(sketch: Sketch, at: Place, { reach, grid, from, except }: Snapping): Anchor {
  const point = pointAt(sketch, at, reach, except);
  if (point !== null) return { at: sketch.points[point]!, point };
  const on = except ? null : linkAt(sketch, at, 0.6 * reach);
  if (on !== null) return { ...on, at: [tidy(on.at[0], 0.1 * reach), tidy(on.at[1], 0.1 * reach)] };
  if (from) {
    const found = alongFrom(sketch, from, at, reach);
    if (found !== null) return found;
  }
  const [x, y] = grid > 0 ? at.map((c) => Math.round(c / grid) * grid) : at;
  return { at: [tidy(x!, grid || reach), tidy(y!, grid || reach)] };
}

/** A place at a multiple of 90°, or at the length of another link, from the other end. */
function alongFrom(sketch: Sketch, from: Place, at: Place, reach: number): Anchor | null {
  const length = distance(from, at);
  if (length < reach) return null;
  const angle = Math.atan2(at[1] - from[1], at[0] - from[0]);
  const quarter = Math.round(angle / (Math.PI / 2)) * (Math.PI / 2);
  const straight = Math.abs(Math.sin(angle - quarter)) * length < 0.4 * reach;
  const alike = lengths(sketch).find(([, own]) => Math.abs(own - length) < 0.4 * reach);
  if (!straight && !alike) return null;
  const [towards, far] = [straight ? quarter : angle, alike ? alike[1] : length];
  const hints = [straight ? (Math.abs(Math.sin(quarter)) > 0.5 ? "vertical" : "horizontal") : "", alike ? `= ${alike[0]}` : ""];
  const own: Place = [from[0] + far * Math.cos(towards), from[1] + far * Math.sin(towards)];
  const step = 0.02 * reach;
  return { at: [tidy(own[0], step), tidy(own[1], step)], hint: hints.filter(Boolean).join(", ") };
}

/** Distances of neighbouring points of links, by name. */
function lengths({ points, links }: Sketch): [string, number][] {
  return links.flatMap((link) =>
    link.name === "ground"
      ? []
      : link.points.slice(1).flatMap((b, k): [string, number][] => {
          const a = link.points[k]!;
          return points[a] && points[b] ? [[`${a} ${b}`, distance(points[a]!, points[b]!)]] : [];
        }),
  );
}

/** A coordinate rounded to a hundredth of a step. */
export function tidy(value: number, step: number): number {
  const unit = roundStep(step / 100);
  return Number((Math.round(value / unit) * unit).toPrecision(12)) + 0;
}
