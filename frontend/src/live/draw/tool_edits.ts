// The edits that a click or a drag with a tool makes, and those of the selection.

import type { FileState, LiveEdit } from "../../messages";
import { clean } from "../ranges";
import { linkBetween, pointOn, sliderAt } from "./drawn_edits";
import type { Anchor, Place, Places } from "./geometry";
import type { Chosen } from "./selected";

/** A click, or a drag if it `moved`, on the drawing. */
export interface Drawn {
  readonly start: Anchor;
  readonly end: Anchor;
  readonly moved: boolean;
  /** The symbol of a part at the place. */
  readonly part: string | undefined;
  /** Half the length of a guide. */
  readonly span: number;
}

/** The edits of a tool, or what to do instead. */
export function toolEdits(tool: string, file: FileState, { start, end, moved, part, span }: Drawn): readonly LiveEdit[] | string {
  const known = { points: file.points, links: file.links, parts: file.parts };
  switch (tool) {
    case "link":
      return moved ? (linkBetween(known, start, end) ?? []) : "Drag: press at one end of the link, release at the other.";
    case "point": {
      const on = start.link ?? file.links.find(({ name, points }) => name !== "ground" && points.includes(start.point ?? ""))?.name;
      return on ? (pointOn(known, on, moved ? end.at : start.at) ?? []) : "Begin on the link that the point belongs to.";
    }
    case "slider":
      return start.point ? (sliderAt(known, start.point, start.at, moved ? end.at : start.at, span) ?? []) : "Begin at the pin that slides.";
    case "ground":
      return start.point ? [{ kind: "set_ground", points: [start.point], on: !isFixed(file, start.point) }] : "Click a pin.";
    case "drive":
      return driven(file, start, part);
    case "trace":
      if (start.point) return [{ kind: "trace_point", point: start.point, on: !file.traced.includes(start.point) }];
      return start.link ? (pointOn(known, start.link, start.at, true) ?? []) : "Click a pin or a link.";
  }
  return [];
}

function isFixed(file: FileState, point: string): boolean {
  return file.links.some(({ name, points }) => name === "ground" && points.includes(point));
}

function driven(file: FileState, { link, point }: Anchor, part: string | undefined): LiveEdit[] {
  const symbol = point ? undefined : file.drives.find(({ kind, name }) => kind !== "link" && name === part);
  if (symbol) return [driving(file, symbol.kind, symbol.name)];
  const own = file.links.filter(({ name, points }) => name !== "ground" && points.includes(point ?? ""));
  const name = link ?? own[0]?.name;
  return name ? [driving(file, "link", name)] : [];
}

/** Drive something: one input more where a draft lacks one, otherwise instead of the first. */
export function driving(file: FileState, drive: string, name: string): LiveEdit {
  const offered = file.lacks.flatMap(({ remedies }) => remedies.flatMap(({ edits }) => edits));
  const missing = offered.find((edit) => edit.kind === "set_input");
  return { kind: "set_input", number: missing?.number ?? 0, drive, name };
}

/** The selected points moved. */
export function shifted(points: Places, selected: Iterable<string>, [dx, dy]: Place): Record<string, [number, number]> {
  return Object.fromEntries(
    [...selected].flatMap((name) => {
      const at = points[name];
      return at ? [[name, [clean(at[0] + dx), clean(at[1] + dy)] as [number, number]] as const] : [];
    }),
  );
}

/** The selected part, link or points removed. */
export function removed(chosen: Chosen | null, selected: Iterable<string>): LiveEdit[] {
  if (chosen?.kind === "part") return [{ kind: "remove_part", name: chosen.name, whole: true }];
  if (chosen?.kind === "link") return [{ kind: "remove_link", name: chosen.name }];
  return [...selected].map((name) => ({ kind: "remove_point", name }));
}
