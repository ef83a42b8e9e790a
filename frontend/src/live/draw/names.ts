// Names of new points and links.

const LETTERS = "ABCDFGHJKLMNPQRSTUVWXYZ"; // no E, I, O: these are easily misread in formulas

/** Free names of points: A, B, C, …, A1, B1, … */
export function freePoints(taken: Iterable<string>, count: number): string[] {
  const known = new Set(Array.from(taken, (name) => name.toLowerCase()));
  const found: string[] = [];
  for (let round = 0; found.length < count; round++) {
    for (const letter of LETTERS) {
      const name = round ? `${letter}${round}` : letter;
      if (found.length < count && !known.has(name.toLowerCase())) found.push(name);
    }
  }
  return found;
}

/** A free name: link2, link3, …; the ground is the first link. */
export function freeName(taken: Iterable<string>, base: string, first = 1): string {
  const known = new Set(Array.from(taken, (name) => name.toLowerCase()));
  let number = first;
  while (known.has(`${base}${number}`)) number++;
  return `${base}${number}`;
}
