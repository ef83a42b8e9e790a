// The mechanisms of the library, as they are kept in the page.

/** A cam or a curve, about a point with which it turns [degrees, clockwise]. */
export interface Outline {
  readonly center: number;
  readonly points: readonly number[];
  readonly closed: boolean;
  readonly turns: readonly number[];
}

export interface Picture {
  readonly box: readonly [number, number];
  readonly closed: boolean;
  readonly bars: readonly (readonly number[])[];
  readonly fixed: readonly number[];
  readonly pins: readonly number[];
  readonly blocks: readonly (readonly [number, number, number])[];
  readonly discs: readonly (readonly [number, number])[];
  readonly outlines: readonly Outline[];
  readonly traces: readonly (readonly number[])[];
  readonly frames: readonly (readonly number[])[];
}

export interface Entry {
  readonly name: string;
  readonly title: string;
  readonly purpose: string;
  readonly family: string;
  readonly picture?: Picture;
}

/** The library in the page; none where it has not been put in. */
export function libraryOf(page: Document): readonly Entry[] {
  const text = page.getElementById("linkwork-library")?.textContent;
  return text ? (JSON.parse(text) as Entry[]) : [];
}

/** Entries in which every word of a search occurs, best first: in the name, the family, the purpose. */
export function searched(entries: readonly Entry[], search: string): readonly Entry[] {
  const words = search.toLowerCase().split(/[\s,]+/).filter(Boolean);
  if (!words.length) return entries;
  const rank = ({ name, title, family, purpose }: Entry): number => {
    const texts = [`${title} ${name}`, family, purpose].map((text) => text.toLowerCase());
    const ranks = words.map((word) => texts.findIndex((text) => text.includes(word)));
    return ranks.includes(-1) ? Infinity : Math.max(...ranks);
  };
  return entries
    .map((entry) => ({ entry, rank: rank(entry) }))
    .filter((one) => one.rank < Infinity)
    .sort((one, other) => one.rank - other.rank)
    .map((one) => one.entry);
}

/** The frame shown at a time [s]: around a closed motion, to and fro over an open one. */
export function frameAt(count: number, closed: boolean, seconds: number, lasting = 3): number {
  if (count < 2) return 0;
  const share = (seconds / lasting) % 1;
  if (closed) return Math.floor(share * count) % count;
  const way = share < 0.5 ? 2 * share : 2 - 2 * share;
  return Math.min(count - 1, Math.round(way * (count - 1)));
}
