// Symbols of parts under the pointer.

import type { FileState, PartShown } from "../../messages";

export interface Under {
  readonly part?: string;
  readonly link?: string;
}

/** The part and the link whose symbols are under the pointer. */
export function symbolsAt(event: { clientX: number; clientY: number }, within: Element, file: FileState): Under {
  const links = new Set(file.links.map((link) => link.name));
  const parts = new Set(file.parts);
  let found: Under = {};
  for (const element of document.elementsFromPoint(event.clientX, event.clientY)) {
    const of = (element as SVGElement).dataset?.of;
    if (of === undefined || !within.contains(element) || element.classList.contains("lw-name")) continue;
    if (!found.part && parts.has(of)) found = { ...found, part: of };
    if (!found.link && links.has(of) && of !== "ground") found = { ...found, link: of };
  }
  const { part, link } = found;
  return part || !link ? found : { ...found, ...wheelOf(link, file) };
}

/** The part of a wheel or block, whose disc has the name of the link. */
function wheelOf(link: string, file: FileState): Under {
  const own = file.links.find(({ name }) => name === link);
  const part = own?.points.length === 1 ? partsOf(link, file)[0] : undefined;
  return part ? { part: part.name } : {};
}

/** The parts that a link belongs to. */
export function partsOf(link: string, file: FileState): PartShown[] {
  return file.part_entries.filter(({ links }) => links.includes(link));
}
