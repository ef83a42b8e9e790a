// A four-bar, a slider-crank or a skeleton of any mechanism in one position, drawn in pixels.

import type { DesignFound, SkeletonShown } from "../messages";
import { svg } from "../svg";
import type { Place } from "./geometry";

/** Places on the screen of points of the plane. */
export type Project = (place: Place) => Place;

/** A, B and P of a row. */
export function jointsOf(row: readonly number[]): [Place, Place, Place] {
  return [[row[0]!, row[1]!], [row[2]!, row[3]!], [row[4]!, row[5]!]];
}

/** The driven parts at A and at B. */
const DRIVES = [["A0", "slider at A"], ["B0", "slider"]] as const;

/** Draw a design at a row of its points into a group. */
export function drawLinkage(group: Element, design: Pick<DesignFound, "fixed" | "design" | "guided" | "lines">, row: readonly number[], project: Project, named = false): void {
  const [a, b, p] = jointsOf(row).map(project) as [Place, Place, Place];
  const sides = [a, b].map((joint, k) => ({ joint, held: design.fixed[k]!.map(project), turn: design.lines[k]!, driven: (DRIVES[k] as readonly string[]).includes(design.design.drive) }));
  for (const { held } of sides) if (held.length > 1) line(group, held[0]!, held[1]!, "lw-t-rail");
  plate(group, [a, b, p]);
  const coupler = Math.atan2(a[1] - b[1], b[0] - a[0]);
  for (const { joint, held, turn, driven } of [...sides].reverse()) {
    const pivot = held[0]!;
    if (held.length > 1) block(group, joint, pivot, held[1]!, driven);
    else if (turn === null) line(group, pivot, joint, `lw-t-bar lw-t-${driven ? "driven" : "rocker"}`);
    else {
      // a line of the coupler slides in a block that turns about the pivot
      const [dx, dy] = [26 * Math.cos(coupler + turn), -26 * Math.sin(coupler + turn)];
      const sense = (pivot[0] - joint[0]) * dx + (pivot[1] - joint[1]) * dy < 0 ? -1 : 1;
      line(group, [joint[0] - sense * dx, joint[1] - sense * dy], [pivot[0] + sense * dx, pivot[1] + sense * dy], "lw-t-rod");
      block(group, pivot, [pivot[0] - dx, pivot[1] - dy], [pivot[0] + dx, pivot[1] + dy], driven);
    }
  }
  const pivots = sides.flatMap(({ held }) => (held.length > 1 ? [] : held));
  for (const place of pivots) ground(group, place);
  for (const [x, y] of [a, b, ...pivots]) svg("circle", { cx: x, cy: y, r: 4.5, class: "lw-t-pin" }, group);
  if (named) {
    sides.forEach(({ joint, held }, k) => held.length > 1 || label(group, ["A₀", "B₀"][k]!, held[0]!, joint));
    label(group, "A", a, b);
    label(group, "B", b, a);
  }
  if (design.guided === "P") svg("circle", { cx: p[0], cy: p[1], r: 4, class: "lw-t-guided" }, group);
}

/** Draw a mechanism of any kind at a row of its points; `pixel`: the size of one in the plane. */
export function drawSkeleton(group: Element, skeleton: SkeletonShown, row: readonly number[], project: Project, pixel: number): void {
  const at = (point: number): Place => project([row[2 * point]!, row[2 * point + 1]!]);
  for (const [centre, radius] of skeleton.discs) {
    const [x, y] = at(centre);
    svg("circle", { cx: x, cy: y, r: radius / pixel, class: "lw-t-wheel" }, group);
  }
  skeleton.bars.forEach((points, k) => {
    const driven = skeleton.driven[k] ? " lw-t-driven" : " lw-t-rocker";
    if (points.length > 2) plate(group, points.map(at), driven);
    else if (points.length === 2) line(group, at(points[0]!), at(points[1]!), `lw-t-bar${driven}`);
  });
  for (const [point, one, other] of skeleton.blocks) {
    rail(group, at(one), at(other), at(point));
    block(group, at(point), at(one), at(other), false);
  }
  for (const point of skeleton.fixed) ground(group, at(point));
  for (const point of skeleton.pins) {
    const [x, y] = at(point);
    svg("circle", { cx: x, cy: y, r: 4.5, class: "lw-t-pin" }, group);
  }
}

/** The coupler alone, thin: another position of the same design. */
export function drawGhost(group: Element, row: readonly number[], project: Project): void {
  const places = jointsOf(row).map(project);
  svg("path", { d: `M${places.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}Z`, class: "lw-t-ghost" }, group);
}

function plate(group: Element, corners: readonly Place[], name = ""): void {
  const d = `M${corners.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}Z`;
  svg("path", { d, class: `lw-t-plate${name}` }, group);
}

/** The line of a block, which ends a little beyond it. */
function rail(group: Element, [x1, y1]: Place, [x2, y2]: Place, [x, y]: Place): void {
  const length = Math.hypot(x2 - x1, y2 - y1) || 1;
  const [dx, dy] = [(x2 - x1) / length, (y2 - y1) / length];
  const at = (x - x1) * dx + (y - y1) * dy;
  const [from, to] = [Math.min(0, at - 30), Math.max(length, at + 30)];
  line(group, [x1 + from * dx, y1 + from * dy], [x1 + to * dx, y1 + to * dy], "lw-t-rail");
}

function line(group: Element, [x1, y1]: Place, [x2, y2]: Place, name: string): void {
  svg("line", { x1: x1.toFixed(1), y1: y1.toFixed(1), x2: x2.toFixed(1), y2: y2.toFixed(1), class: name }, group);
}

/** The name of a joint, away from another place, and from the hatching below a fixed pivot. */
function label(group: Element, name: string, [x, y]: Place, [u, v]: Place): void {
  const away = Math.hypot(x - u, y - v);
  const [dx, dy] = away < 1 ? [-1, 0] : [(x - u) / away, (y - v) / away];
  const far = name.length > 1 && dy > 0.3 ? 30 : 16;
  svg("text", { x: (x + far * dx).toFixed(1), y: (y + far * dy).toFixed(1), "text-anchor": "middle", dy: "0.35em", class: "lw-t-name" }, group).textContent = name;
}

/** A fixed pivot: a triangle on hatching. */
function ground(group: Element, [x, y]: Place): void {
  svg("path", { d: `M${x} ${y}l-9 13h18zM${x - 13} ${y + 13}h26M${x - 9} ${y + 13}l-5 6m10-6l-5 6m10-6l-5 6m10-6l-5 6`, class: "lw-t-ground" }, group);
}

function block(group: Element, [x, y]: Place, [x1, y1]: Place, [x2, y2]: Place, driven: boolean): void {
  const angle = (Math.atan2(y2 - y1, x2 - x1) * 180) / Math.PI;
  svg("rect", { x: x - 15, y: y - 9, width: 30, height: 18, rx: 2, class: driven ? "lw-t-block lw-t-driven" : "lw-t-block", transform: `rotate(${angle.toFixed(2)} ${x.toFixed(1)} ${y.toFixed(1)})` }, group);
}
