// What is drawn, as edits of the file.

import type { FileState, LiveEdit } from "../../messages";
import { clean } from "../ranges";
import type { Anchor, Place } from "./geometry";
import { freeName, freePoints } from "./names";

type Known = Pick<FileState, "points" | "links" | "parts">;

const taken = ({ points, links, parts }: Known): string[] => [...Object.keys(points), ...links.map((link) => link.name), ...parts];

/** A link between two anchors; null if it has no length or exists. */
export function linkBetween(file: Known, start: Anchor, end: Anchor): LiveEdit[] | null {
  if (start.at[0] === end.at[0] && start.at[1] === end.at[1]) return null;
  if (start.point && file.links.some(({ points }) => points.includes(start.point!) && points.includes(end.point ?? ""))) return null;
  const names = freePoints(taken(file), 2);
  const edits: LiveEdit[] = [];
  const ends = [start, end].map((anchor) => {
    if (anchor.point) return anchor.point;
    const name = names.shift()!;
    edits.push(newPoint(name, anchor.at, anchor.link ? [anchor.link] : []));
    return name;
  });
  edits.push({ kind: "add_link", name: freeName(taken(file), "link", 2), points: ends });
  return edits;
}

/** A further point of a link. */
export function pointOn(file: Known, link: string, at: Place, traced = false): LiveEdit[] {
  const [name] = freePoints(taken(file), 1);
  const edits: LiveEdit[] = [newPoint(name!, at, [link])];
  if (traced) edits.push({ kind: "trace_point", point: name!, on: true });
  return edits;
}

/** A block pinned at a point, which slides along a fixed line. */
export function sliderAt(file: Known, point: string, at: Place, towards: Place, size: number): LiveEdit[] {
  const far = Math.hypot(towards[0] - at[0], towards[1] - at[1]);
  const [u, v] = far > 0 ? [(towards[0] - at[0]) / far, (towards[1] - at[1]) / far] : [1, 0];
  const [a, b] = freePoints(taken(file), 2);
  const block = freeName(taken(file), "block");
  return [
    newPoint(a!, [at[0] - size * u, at[1] - size * v], []),
    newPoint(b!, [at[0] + size * u, at[1] + size * v], []),
    { kind: "set_ground", points: [a!, b!] },
    { kind: "add_link", name: block, points: [point] },
    { kind: "add_part", table: "sliders", typed: { name: freeName(taken(file), "s"), link: block, points: [point], on: "ground", line: [a!, b!] } },
  ];
}

function newPoint(name: string, [x, y]: Place, links: readonly string[]): LiveEdit {
  return { kind: "add_point", name, x: clean(x), y: clean(y), links };
}
