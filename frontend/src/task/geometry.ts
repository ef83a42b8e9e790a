// Points of the plane, boxes around them, and curves through them.

export type Place = readonly [number, number];
export type Box = [number, number, number, number];

/** Pairs of x, y, x, y, … */
export function pairs(flat: readonly number[]): Place[] {
  const found: Place[] = [];
  for (let k = 0; k + 1 < flat.length; k += 2) found.push([flat[k]!, flat[k + 1]!]);
  return found;
}

/** The box around places; null without any. */
export function boxAround(places: Iterable<Place>): Box | null {
  let box: Box | null = null;
  for (const [x, y] of places) {
    if (!Number.isFinite(x) || !Number.isFinite(y)) continue;
    if (box === null) box = [x, y, x, y];
    else box = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
  }
  return box;
}

export function distance([x, y]: Place, [u, v]: Place): number {
  return Math.hypot(x - u, y - v);
}

/** A number rounded to the decimals that a step on the screen can show. */
export function roundedTo(value: number, step: number): number {
  const decimals = Math.max(0, -Math.floor(Math.log10(step)));
  const rounded = decimals > 15 ? value : Number(value.toFixed(decimals));
  return rounded === 0 ? 0 : rounded;
}

/** Points at equal distances along a drawn line; a line that returns to its start is closed, and its end left out. */
export function resampled(drawn: readonly Place[], count: number): Place[] {
  if (drawn.length < 2) return [...drawn];
  const length = drawn.slice(1).reduce((sum, place, k) => sum + distance(place, drawn[k]!), 0);
  const closed = distance(drawn[0]!, drawn.at(-1)!) < 0.12 * length;
  const line = closed ? [...drawn, drawn[0]!] : drawn;
  const lengths = [0];
  for (let k = 1; k < line.length; k++) lengths.push(lengths[k - 1]! + distance(line[k]!, line[k - 1]!));
  const whole = lengths.at(-1)!;
  if (!(whole > 0)) return [drawn[0]!];
  const found: Place[] = [];
  let at = 1;
  for (let k = 0; k < count; k++) {
    const wanted = (whole * k) / (closed ? count : count - 1);
    while (at < line.length - 1 && lengths[at]! < wanted) at += 1;
    const [from, to] = [line[at - 1]!, line[at]!];
    const part = lengths[at]! - lengths[at - 1]!;
    const share = part > 0 ? (wanted - lengths[at - 1]!) / part : 0;
    found.push([from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])]);
  }
  return found;
}

/** The designs that no other one beats in both numbers: the first as small, the second as large as possible. */
export function front(pairsOf: readonly Place[]): number[] {
  const order = pairsOf.map((_, k) => k).sort((a, b) => pairsOf[a]![0] - pairsOf[b]![0] || pairsOf[b]![1] - pairsOf[a]![1]);
  let best = -Infinity;
  return order.filter((k) => {
    const better = pairsOf[k]![1] > best;
    if (better) best = pairsOf[k]![1];
    return better;
  });
}
