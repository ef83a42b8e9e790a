// Duplicate and mirror what is selected, as edits of the file.

import type { FileState, LiveEdit } from "../../messages";
import { clean } from "../ranges";
import { distance, type Place, type Places } from "./geometry";
import { freeName, freePoints } from "./names";

/** What is selected: points, and links between them. */
export interface Selection {
  readonly points: readonly string[];
  readonly links: readonly string[];
}

/** A line to mirror about: a place on it and its direction. */
export interface Line {
  readonly at: Place;
  readonly along: Place;
}

/** Copies that move less than this part of the selection's size are the point itself. */
const SAME = 1e-9;

/** Selected points with the links between them, or a link with its points. */
export function selectionOf(file: FileState, points: ReadonlySet<string>, link?: string): Selection {
  if (link !== undefined) return { points: file.links.find((one) => one.name === link)?.points ?? [], links: [link] };
  const within = file.links.filter((one) => one.name !== "ground" && one.points.length > 1 && one.points.every((point) => points.has(point)));
  return { points: [...points], links: within.map((one) => one.name) };
}

/** The image of a place in a line. */
export function mirrored([x, y]: Place, { at, along }: Line): Place {
  const [u, v] = along;
  const twice = (2 * ((x - at[0]) * u + (y - at[1]) * v)) / (u * u + v * v);
  return [clean(2 * at[0] - x + twice * u), clean(2 * at[1] - y + twice * v)];
}

/** The centre of places. */
export function centreOf(places: readonly Place[]): Place {
  const middle = (values: readonly number[]): number => (Math.min(...values) + Math.max(...values)) / 2;
  return [middle(places.map(([x]) => x)), middle(places.map(([, y]) => y))];
}

/** A copy of a selection at other places. */
export function duplicate(file: FileState, points: Places, chosen: Selection, to: (at: Place) => Place, isMirrored = false): LiveEdit {
  const taken = [...Object.keys(points), ...file.links.map(({ name }) => name), ...file.parts, ...file.numbers.map(({ name }) => name)];
  const moved = chosen.points.map((name) => [name, to(points[name]!)] as const);
  const size = Math.max(...chosen.points.map((name) => Math.hypot(...points[name]!)), 0);
  const own = new Set(moved.filter(([name, place]) => distance(place, points[name]!) <= SAME * size).map(([name]) => name));
  const fresh = freePoints(taken, chosen.points.length - own.size);
  const names: Record<string, string> = {};
  const places: Record<string, [number, number]> = {};
  for (const [name, [x, y]] of moved) {
    names[name] = own.has(name) ? name : fresh.shift()!;
    if (!own.has(name)) places[name] = [x, y];
  }
  for (const link of chosen.links) {
    names[link] = freeName([...taken, ...Object.values(names)], link.replace(/\d+$/, "") || link, 2);
  }
  return { kind: "duplicate", names, places, mirrored: isMirrored };
}

/** The selection itself at mirrored places. */
export function mirror(points: Places, chosen: Selection, line: Line): LiveEdit {
  return { kind: "mirror", places: Object.fromEntries(chosen.points.map((name) => [name, [...mirrored(points[name]!, line)] as [number, number]])) };
}
