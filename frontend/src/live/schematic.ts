// A simple drawing of links and points without a motion: for an open mechanism, an iterate, a
// configuration or a sketch.

import type { Link, OpenEnd } from "../messages";
import { printedName } from "../numbers";
import { pathOf, svg } from "../svg";

export type Points = Readonly<Record<string, readonly [number, number]>>;

export interface Box {
  readonly left: number;
  readonly bottom: number;
  readonly right: number;
  readonly top: number;
}

/** The box around points with a margin; never empty. */
export function boxAround(points: readonly (readonly [number, number])[]): Box {
  if (!points.length) return { left: -1, bottom: -1, right: 1, top: 1 };
  const xs = points.map(([x]) => x);
  const ys = points.map(([, y]) => y);
  const [left, right, bottom, top] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const air = 0.12 * Math.max(right - left, top - bottom) || 1;
  return { left: left - air, bottom: bottom - air, right: right + air, top: top + air };
}

export function viewBox({ left, bottom, right, top }: Box): string {
  return `${left} ${-top} ${right - left} ${top - bottom}`;
}

export interface Look {
  /** Stroke width, in the unit of the plane. */
  readonly stroke: number;
  readonly names?: number;
  readonly ends?: readonly OpenEnd[];
}

/** Draw links and points into a group. */
export function drawLinks(group: SVGGElement, links: readonly Link[], points: Points, look: Look): void {
  group.replaceChildren();
  const { stroke } = look;
  const ends = look.ends ?? [];
  for (const link of links) {
    const places = link.points.flatMap((name) => {
      const own = ends.find((end) => end.link === link.name && end.point === name);
      const place = own?.end ?? points[name];
      return place ? [place] : [];
    });
    if (places.length < 2) continue;
    const ground = link.name === "ground";
    const d = pathOf(places.flat(), places.length > 2);
    const kind = ground ? "ground" : places.length > 2 ? "plate" : "bar";
    svg("path", { class: `lw-plain-${kind}`, d, "stroke-width": (ground ? 1 : 2.4) * stroke }, group);
  }
  drawGaps(group, ends, stroke);
  for (const [name, [x, y]] of Object.entries(points)) {
    svg("circle", { class: "lw-plain-pin", cx: x, cy: -y, r: 2.6 * stroke, "stroke-width": 1.2 * stroke }, group);
    if (!look.names) continue;
    const text = svg("text", { x: x + 0.6 * look.names, y: -y - 0.6 * look.names, "font-size": look.names }, group);
    text.textContent = printedName(name);
  }
}

/** Dashed lines between ends of links that do not meet. */
export function drawGaps(group: SVGGElement, ends: readonly OpenEnd[], stroke: number): void {
  for (const { joint, end } of ends) {
    svg("path", { class: "lw-gap", d: pathOf([...joint, ...end], false), "stroke-width": 2 * stroke }, group);
    for (const [x, y] of [joint, end]) {
      svg("circle", { class: "lw-gap-end", cx: x, cy: -y, r: 4.5 * stroke, "stroke-width": 1.5 * stroke }, group);
    }
  }
}

/** A separate picture. */
export function pictureOf(links: readonly Link[], points: Points, ends: readonly OpenEnd[] = [], names = true): SVGSVGElement {
  const box = boxAround([...Object.values(points), ...ends.map((end) => end.end)]);
  const size = Math.max(box.right - box.left, box.top - box.bottom);
  const element = svg("svg", { viewBox: viewBox(box), class: "lw-plain", "aria-hidden": "true" });
  drawLinks(svg("g", {}, element), links, points, { stroke: size / 260, ends, ...(names ? { names: size / 32 } : {}) });
  return element;
}
