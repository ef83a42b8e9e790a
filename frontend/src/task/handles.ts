// What of a task can be dragged: positions and poses, pivots, corners, obstacles.

import type { TaskState } from "../messages";
import { measured } from "../numbers";
import { put, svg } from "../svg";
import { distance, type Place } from "./geometry";
import type { Project } from "./linkage_drawing";

/** One handle: a thing of the task, or the angle or radius of one. */
export interface Thing {
  readonly of: "position" | "fixed pivot" | "moving pivot" | "corner" | "obstacle";
  readonly index: number;
  /** The knob that turns a pose, or changes the radius of an obstacle. */
  readonly knob: boolean;
}

/** Length of the arrow of a pose [px]. */
export const ARM = 44;

/** Radius of a position, of one among many, and the least one that holds a number [px]. */
const [RING, DOT, NUMBERED] = [10, 4, 7];

export const sameThing = (one: Thing | null, other: Thing | null): boolean => one !== null && other !== null && one.of === other.of && one.index === other.index && one.knob === other.knob;

export const radians = (task: TaskState): number => (task.angle_unit === "rad" ? 1 : Math.PI / 180);

/** Where a thing is in the plane; null if there is none. */
export function placeOf(task: TaskState, { of, index }: Thing): Place | null {
  if (of === "position") {
    const at = task.positions[index];
    return at ? [at.x, at.y] : null;
  }
  const lists = { "fixed pivot": task.fixed_pivots, "moving pivot": task.moving_pivots, corner: task.region };
  if (of === "obstacle") {
    const found = task.obstacles[index];
    return found ? [found[0], found[1]] : null;
  }
  return lists[of][index] ?? null;
}

/** Handles as elements that keep the focus while they move. */
export class Handles {
  private readonly made = new Map<string, SVGGElement>();

  constructor(
    private readonly layer: Element,
    private readonly focused: (thing: Thing) => void,
  ) {}

  draw(task: TaskState, project: Project, pixel: number, picked: Thing | null, at: number | null): void {
    const used = new Set<string>();
    const radius = radiusOf(task.positions.map(({ x, y }) => project([x, y])));
    for (const thing of thingsOf(task)) {
      const key = `${thing.of} ${thing.index} ${thing.knob}`;
      used.add(key);
      let element = this.made.get(key);
      if (!element) {
        element = this.make(thing);
        this.made.set(key, element);
      }
      const [x, y] = this.spot(task, thing, project, pixel);
      put(element, { transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})`, "aria-label": nameOf(task, thing) });
      element.classList.toggle("lw-t-picked", sameThing(thing, picked));
      element.classList.toggle("lw-t-here", thing.of === "position" && thing.index === at);
      if (thing.of === "position" && !thing.knob) shapePosition(element, task, thing.index, radius);
      if (thing.of === "obstacle" && !thing.knob) put(element.querySelector(".lw-t-disc")!, { r: task.obstacles[thing.index]![2] / pixel });
    }
    for (const [key, element] of this.made) {
      if (used.has(key)) continue;
      element.remove();
      this.made.delete(key);
    }
  }

  focus(thing: Thing): void {
    this.made.get(`${thing.of} ${thing.index} ${thing.knob}`)?.focus();
  }

  private spot(task: TaskState, thing: Thing, project: Project, pixel: number): Place {
    const place = placeOf(task, thing)!;
    const [x, y] = project(place);
    if (!thing.knob) return [x, y];
    if (thing.of === "obstacle") return [x + task.obstacles[thing.index]![2] / pixel, y];
    const angle = (task.positions[thing.index]!.angle ?? 0) * radians(task);
    return [x + ARM * Math.cos(angle), y - ARM * Math.sin(angle)];
  }

  private make(thing: Thing): SVGGElement {
    const group = svg("g", { class: `lw-t-handle lw-t-${thing.of.replace(" ", "-")}${thing.knob ? " lw-t-knob" : ""}`, tabindex: 0, role: "button", "data-of": thing.of, "data-index": thing.index, "data-knob": String(thing.knob) }, this.layer);
    group.addEventListener("focus", () => this.focused(thing));
    if (thing.of === "obstacle" && !thing.knob) svg("circle", { class: "lw-t-disc", r: 1 }, group);
    svg("circle", { r: 15, class: "lw-t-reach" }, group);
    if (thing.knob) svg("circle", { r: 6, class: "lw-t-dot" }, group);
    else if (thing.of === "position") {
      svg("path", { class: "lw-t-arm" }, group);
      svg("circle", { r: 10, class: "lw-t-dot" }, group);
      svg("text", { "text-anchor": "middle", dy: "0.36em" }, group);
    } else if (thing.of === "corner") svg("rect", { x: -5, y: -5, width: 10, height: 10, class: "lw-t-dot" }, group);
    else if (thing.of === "fixed pivot") svg("path", { d: "M0 -8l8 8-8 8-8-8z", class: "lw-t-dot" }, group);
    else svg("circle", { r: 5, class: "lw-t-dot" }, group);
    return group;
  }
}

function* thingsOf(task: TaskState): Iterable<Thing> {
  for (const [index] of task.obstacles.entries()) {
    yield { of: "obstacle", index, knob: false };
    yield { of: "obstacle", index, knob: true };
  }
  for (const [index] of task.region.entries()) yield { of: "corner", index, knob: false };
  for (const [index] of task.fixed_pivots.entries()) yield { of: "fixed pivot", index, knob: false };
  for (const [index] of task.moving_pivots.entries()) yield { of: "moving pivot", index, knob: false };
  for (const [index, { angle }] of task.positions.entries()) {
    yield { of: "position", index, knob: false };
    if (angle !== null) yield { of: "position", index, knob: true };
  }
}

function shapePosition(element: Element, task: TaskState, index: number, radius: number): void {
  const { angle } = task.positions[index]!;
  element.querySelector("text")!.textContent = radius < NUMBERED ? "" : String(index + 1);
  put(element.querySelector("text")!, { "font-size": 1.2 * radius });
  put(element.querySelector(".lw-t-dot")!, { r: radius });
  const turned = (angle ?? 0) * radians(task);
  const [c, s] = [Math.cos(turned), -Math.sin(turned)];
  // an arrow along the body, and a short one across it
  put(element.querySelector(".lw-t-arm")!, { d: angle === null ? "" : `M0 0L${(ARM * c).toFixed(1)} ${(ARM * s).toFixed(1)}M0 0L${(22 * s).toFixed(1)} ${(-22 * c).toFixed(1)}` });
}

/** The radius of the rings of positions, which do not cover each other [px]. */
export function radiusOf(places: readonly Place[]): number {
  if (places.length > 12) return DOT;
  const gaps = places.flatMap((place, k) => places.slice(k + 1).map((other) => distance(place, other)));
  return Math.max(DOT, Math.min(RING, ...gaps.map((gap) => gap / 2)));
}

/** What a screen reader says of a handle. */
export function nameOf(task: TaskState, thing: Thing): string {
  const [x, y] = placeOf(task, thing)!;
  const unit = task.length_unit;
  const where = `x ${measured(x, unit)}, y ${measured(y, unit)}`;
  if (thing.of === "position") {
    const { angle } = task.positions[thing.index]!;
    const turned = angle === null ? "" : measured(angle, task.angle_unit);
    if (thing.knob) return `Angle of position ${thing.index + 1}: ${turned}`;
    return `Position ${thing.index + 1}: ${where}${turned && `, angle ${turned}`}`;
  }
  if (thing.of === "obstacle") {
    const radius = `radius ${measured(task.obstacles[thing.index]![2], unit)}`;
    return thing.knob ? `Radius of obstacle ${thing.index + 1}: ${radius}` : `Obstacle ${thing.index + 1}: ${where}, ${radius}`;
  }
  const name = { "fixed pivot": "Fixed pivot", "moving pivot": "Moving pivot", corner: "Corner of the region of fixed pivots" }[thing.of];
  return `${name} ${thing.index + 1}: ${where}`;
}
