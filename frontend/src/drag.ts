// Which row a dragged place belongs to: the nearest one on its way, found from where it is, so that
// dragging never jumps to another branch and goes on through dead points.

export interface Step {
  /** Index on the way. */
  readonly at: number;
  /** The direction of the last move along the way: 1, -1, or 0 before the first. */
  readonly sense: number;
}

interface Nearest {
  readonly steps: number;
  readonly distance: number;
}

/**
 * The step from `from` to the place on the way (x, y in turn) that is nearest to (x, y).
 *
 * Both directions are searched downhill; where both come as near, as beside a dead point, the
 * motion goes on in the direction that it had.
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
  const here = distance(from.at);
  const onward = search(count, closed, from.at, 1, here, distance);
  const back = search(count, closed, from.at, -1, here, distance);
  const [best, other] = onward.distance <= back.distance ? [onward, back] : [back, onward];
  let chosen = best;
  const near = Math.abs(best.distance - other.distance) <= 0.05 * Math.max(here, 1e-12);
  if (near && other.steps !== 0 && Math.sign(other.steps) === from.sense) chosen = other;
  if (chosen.steps === 0) return from;
  return {
    at: wrapped(from.at + chosen.steps, count),
    sense: Math.sign(chosen.steps),
  };
}

/** The nearest place in one direction, not further than where the distance has grown for long. */
function search(
  count: number,
  closed: boolean,
  from: number,
  sense: number,
  here: number,
  distance: (k: number) => number,
): Nearest {
  const patience = Math.max(6, Math.round(count / 12));
  let best: Nearest = { steps: 0, distance: here };
  for (let away = 1; away < count; away++) {
    const k = from + sense * away;
    if (!closed && (k < 0 || k >= count)) break;
    const far = distance(wrapped(k, count));
    if (far < best.distance) best = { steps: sense * away, distance: far };
    else if (away - Math.abs(best.steps) > patience) break;
  }
  return best;
}

function wrapped(k: number, count: number): number {
  return ((k % count) + count) % count;
}
