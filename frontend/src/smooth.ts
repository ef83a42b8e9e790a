// Lines through points as smooth curves in SVG: cubic pieces where a straight one would be seen.
// The curves are those of src/linkwork/core/drawing/paths.py.

export type Spot = readonly [number, number];

/** Cosine of 60°: a line that turns by more between two points has a corner. */
const CORNER = 0.5;

/** The largest unseen deviation from a curve [px]. */
const UNSEEN = 0.1;

/** The path from the first point through all others [px]. */
export function curveThrough(spots: readonly Spot[]): string {
  const pieces = spots.slice(0, 1).map((spot) => `M${written(spot)}`);
  for (let k = 1; k < spots.length; k++) {
    const to = spots[k]!;
    const handles = bent(spots[k - 2], spots[k - 1]!, to, spots[k + 1], UNSEEN);
    pieces.push(handles ? `C${written(handles[0])} ${written(handles[1])} ${written(to)}` : `L${written(to)}`);
  }
  return pieces.join("");
}

/** The points x, y, x, y, … of the curve through others, so near that lines between them are as good. */
export function pointsThrough(spots: readonly Spot[], unseen: number): number[] {
  const points: number[] = [...(spots[0] ?? [])];
  for (let k = 1; k < spots.length; k++) {
    const [from, to] = [spots[k - 1]!, spots[k]!];
    const handles = bent(spots[k - 2], from, to, spots[k + 1], unseen);
    const pieces = handles ? Math.ceil(Math.sqrt(away(from, to, handles) / unseen)) : 1;
    for (let piece = 1; piece < pieces; piece++) {
      const [t, s] = [piece / pieces, 1 - piece / pieces];
      const shares = [s ** 3, 3 * s * s * t, 3 * s * t * t, t ** 3];
      const four = [from, ...handles!, to];
      for (const axis of [0, 1] as const) points.push(four.reduce((sum, one, i) => sum + shares[i]! * one[axis], 0));
    }
    points.push(...to);
  }
  return points;
}

/** How far a cubic piece goes from its chord, at most. */
function away([x, y]: Spot, [u, v]: Spot, handles: readonly Spot[]): number {
  const length = Math.hypot(u - x, v - y);
  return 0.75 * Math.max(...handles.map(([a, b]) => Math.abs((u - x) * (b - y) - (v - y) * (a - x)) / length));
}

function written([x, y]: Spot): string {
  return `${x.toFixed(2)} ${y.toFixed(2)}`;
}

/** The handles of the curve between two points with neighbours; null where a line is as good. */
export function bent(before: Spot | undefined, from: Spot, to: Spot, after: Spot | undefined, unseen: number): [Spot, Spot] | null {
  const chord: Spot = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(...chord);
  if (length <= 4 * unseen) return null;
  let near = before ? turned(tangentAt(before, from, to), chord) : NaN;
  let far = after ? -turned(tangentAt(from, to, after), chord) : NaN;
  if (Number.isNaN(near)) near = far;
  if (Number.isNaN(far)) far = near;
  if (!(length * Math.max(Math.abs(near), Math.abs(far)) > 4 * unseen)) return null;
  const [ahead, back] = [handle(near, far), handle(far, near)];
  const [a, b] = [spun(chord, -near), spun(chord, far)];
  return [
    [from[0] + ahead * a[0], from[1] + ahead * a[1]],
    [to[0] - back * b[0], to[1] - back * b[1]],
  ];
}

/** The tangent at the middle one of three points of a circle; NaN at a corner. */
function tangentAt(before: Spot, at: Spot, after: Spot): Spot {
  const [ax, ay] = [at[0] - before[0], at[1] - before[1]];
  const [bx, by] = [after[0] - at[0], after[1] - at[1]];
  const [a, b] = [ax * ax + ay * ay, bx * bx + by * by];
  if (ax * bx + ay * by < CORNER * Math.sqrt(a * b)) return [NaN, NaN];
  return [ax / a + bx / b, ay / a + by / b];
}

/** The angle from a tangent to the chord; NaN at a corner. */
function turned([tx, ty]: Spot, [cx, cy]: Spot): number {
  const [along, across] = [tx * cx + ty * cy, tx * cy - ty * cx];
  return along > CORNER * Math.hypot(along, across) ? Math.atan2(across, along) : NaN;
}

function spun([x, y]: Spot, angle: number): Spot {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return [cos * x - sin * y, sin * x + cos * y];
}

/** The length of a handle by the angles at its own and at the other end (J. D. Hobby, 1986). */
function handle(near: number, far: number): number {
  const odd = (Math.sin(near) - Math.sin(far) / 16) * (Math.sin(far) - Math.sin(near) / 16);
  const rise = 2 + Math.SQRT2 * odd * (Math.cos(near) - Math.cos(far));
  const root = Math.sqrt(5);
  return rise / (3 * (1 + 0.5 * (root - 1) * Math.cos(near) + 0.5 * (3 - root) * Math.cos(far)));
}
