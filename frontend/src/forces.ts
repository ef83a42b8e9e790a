// Forces of pins and loads over the rows of a motion.

import type { MotionView } from "./motion";

export interface PinForce {
  readonly point: number;
  readonly name: string;
  /** The link on which the force acts, and the one that exerts it; "" for loads. */
  readonly on: string;
  readonly by: string;
  /** Its components in a row. */
  readonly at: (row: number) => readonly [number, number];
}

/** All forces whose components are columns. */
export function forcesOf(view: MotionView): PinForce[] {
  const columns = new Map(view.series.map((one) => [one.name, one]));
  const several = new Set(view.data.reactions.filter(({ on, by }) => on && !by).map(({ point }) => point));
  return view.data.reactions.flatMap(({ point, on, by, x, y }) => {
    const [own, other] = [columns.get(x), columns.get(y)];
    if (!own || !other) return [];
    const shown = view.points[point]!.shown;
    const name = on ? `F(${several.has(point) ? `${shown}, ${on}` : shown})` : `P(${shown})`;
    return [{ point, name, on, by, at: (row: number) => [own.values[row]!, other.values[row]!] as const }];
  });
}

/** The unit of the forces; "" without any. */
export function forceUnit(view: MotionView): string {
  const first = view.data.reactions[0]?.x;
  return view.series.find((one) => one.name === first)?.unit ?? "";
}

/** The links with pins that transmit forces. */
export function loadedLinks(view: MotionView): string[] {
  const links = view.data.reactions.flatMap(({ on, by }) => [on, by]);
  return [...new Set(links)].filter((link) => link && link !== "ground");
}

/** The forces of pins on a link: those that others exert on it, and the opposite of its own where
 * two links share a pin. */
export function forcesOn(view: MotionView, link: string): PinForce[] {
  const all = forcesOf(view);
  const named = new Set(all.filter(({ on }) => on === link).map(({ point }) => point));
  return all.flatMap((force) => {
    if (force.on === link) return [force];
    // Where more links share a pin, the force on each has a column of its own.
    if (force.by !== link || named.has(force.point)) return [];
    const at = (row: number): readonly [number, number] => {
      const [x, y] = force.at(row);
      return [-x, -y];
    };
    return [{ ...force, name: `−${force.name}`, on: link, by: force.on, at }];
  });
}
