// The row of a dragged point: the nearest one on its path, searched from the current row, so that
// dragging never jumps to another branch and continues through dead points.

export interface Step {
  /** Index on the path. */
  readonly at: number;
  /** The direction of the last move along the path: 1, -1, or 0 before the first. */
  readonly sense: number;
}

interface Nearest {
  readonly steps: number;
  readonly distance: number;
}

/**
 * The step from `from` to the point of the path (x, y alternating) nearest to (x, y).
 *
 * Both directions are searched for decreasing distance; if both are equally near, as at a dead
 * point, the motion keeps its direction.
 */
export function stepTowards(
  way: Float64Array,
  closed: boolean,
  from: Step,
  x: number,
  y: number,
): Step {
  const count = way.length / 2;
  const distance = (k: number): number => Math.hypot(way[2 * k]! - x, way[2 * k + 1]! - y);
  const search = { way, count, closed, from: from.at, distance };
  const onward = nearest(search, 1);
  const back = nearest(search, -1);
  const [best, other] = onward.distance <= back.distance ? [onward, back] : [back, onward];
  const alike = other.distance - best.distance <= Math.max(spacing(search, best), spacing(search, other));
  let chosen = best;
  if (alike && other.steps !== 0 && Math.sign(other.steps) === from.sense) chosen = other;
  if (chosen.steps === 0) return from;
  return {
    at: wrapped(from.at + chosen.steps, count),
    sense: Math.sign(chosen.steps),
  };
}

interface Search {
  readonly way: Float64Array;
  readonly count: number;
  readonly closed: boolean;
  readonly from: number;
  readonly distance: (k: number) => number;
}

/**
 * The nearest point in one direction, until the distance has increased for long. After an increase,
 * a later point must be nearer by more than the row spacing, since the way back from a dead point
 * passes every point again.
 */
function nearest(search: Search, sense: number): Nearest {
  const { count, closed, from, distance } = search;
  const patience = Math.max(6, Math.round(count / 12));
  let best: Nearest = { steps: 0, distance: distance(from) };
  for (let away = 1; away < count; away++) {
    const k = from + sense * away;
    if (!closed && (k < 0 || k >= count)) break;
    const far = distance(wrapped(k, count));
    const behind = away - Math.abs(best.steps);
    const needed = behind === 1 ? best.distance : best.distance - spacing(search, best);
    if (far < needed) best = { steps: sense * away, distance: far };
    else if (behind > patience) break;
  }
  return best;
}

/** The spacing of rows at the point found. */
function spacing({ way, count, from }: Search, { steps }: Nearest): number {
  const at = wrapped(from + steps, count);
  const apart = (other: number): number =>
    Math.hypot(way[2 * at]! - way[2 * other]!, way[2 * at + 1]! - way[2 * other + 1]!);
  return Math.max(apart(wrapped(at + 1, count)), apart(wrapped(at - 1, count)));
}

function wrapped(k: number, count: number): number {
  return ((k % count) + count) % count;
}
