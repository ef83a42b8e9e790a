// The design before, drawn pale behind the mechanism: its paths, and its links at the same input.

import type { MotionView } from "./motion";
import type { PageData, Part } from "./page_data";
import { pathOf, put, svg } from "./svg";
import { toneClass } from "./theme";

export class Ghost {
  private readonly group: SVGGElement;
  private past: MotionView | null = null;
  private frames: { readonly frame: number; readonly group: SVGGElement }[] = [];

  constructor(
    private readonly data: PageData,
    over: SVGSVGElement,
  ) {
    this.group = svg("g", { class: "lw-ghost", "aria-hidden": "true" });
    over.prepend(this.group);
  }

  /** Show a design, or none. */
  show(past: MotionView | null): void {
    if (past === this.past) return;
    this.past = past;
    this.group.replaceChildren();
    this.frames = [];
    const groups = new Map<number, SVGGElement>();
    for (const part of past?.data.parts ?? []) {
      if (!isGhost(part)) continue;
      let group = groups.get(part.frame);
      if (!group) {
        group = svg("g", {}, this.group);
        groups.set(part.frame, group);
        if (part.frame >= 0) this.frames.push({ frame: part.frame, group });
      }
      this.part(part, group);
    }
  }

  /** Move it to a row. */
  draw(before: Before | null): void {
    if (before === null) return;
    for (const { frame, group } of this.frames) {
      const { x, y, angle } = before.view.pose(frame, before.row);
      put(group, { transform: `translate(${x} ${-y}) rotate(${(-angle * 180) / Math.PI})` });
    }
  }

  private part(part: Part, group: SVGGElement): void {
    const filled = part.kind === "area" || part.kind === "disc";
    const look = { class: `r-${part.role} ${toneClass(part.tone, this.data)}${filled ? " filled" : ""}` };
    const [x, y] = part.points;
    if (part.kind === "disc") svg("circle", { ...look, cx: x!, cy: -y!, r: part.radius }, group);
    else svg("path", { ...look, d: pathOf(part.points, part.kind === "area") }, group);
  }
}

/** A row of the design before. */
export interface Before {
  readonly view: MotionView;
  readonly row: number;
}

/** Whether a shape of the design before is drawn. */
export function isGhost({ kind, frame, role }: Part): boolean {
  return kind !== "text" && kind !== "strokes" && (frame >= 0 || (frame === -1 && role === "trace"));
}

/** The found row whose input is nearest to a value; among equals, the one nearest to a row. */
export function sameInput(view: MotionView, value: number, row: number): number {
  const far = (one: number): number => Math.abs(view.input.values[one]! - value);
  let best = view.order[0] ?? 0;
  for (const one of view.order) {
    const less = far(one) - far(best);
    if (less < -1e-9 || (less < 1e-9 && Math.abs(one - row) < Math.abs(best - row))) best = one;
  }
  return best;
}
