// Elements, and paths as text.

const SPACE = "http://www.w3.org/2000/svg";

type Attributes = Readonly<Record<string, string | number>>;

export function svg<K extends keyof SVGElementTagNameMap>(
  name: K,
  attributes: Attributes = {},
  parent?: Element,
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SPACE, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  parent?.append(element);
  return element;
}

export function html<K extends keyof HTMLElementTagNameMap>(
  name: K,
  attributes: Attributes = {},
  parent?: Element,
  text = "",
): HTMLElementTagNameMap[K] {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  if (text) element.textContent = text;
  parent?.append(element);
  return element;
}

/** Set attributes of an existing element, if they have changed. */
export function put(element: Element, attributes: Attributes): void {
  for (const [key, value] of Object.entries(attributes)) {
    const text = String(value);
    if (element.getAttribute(key) !== text) element.setAttribute(key, text);
  }
}

/** Set the text, if it has changed. */
export function say(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/** A coordinate in a path: short, with more than screen precision. */
function short(number: number): string {
  return String(Number(number.toPrecision(8)));
}

/** x, y, x, y, … of the plane (y up) as a path (y down). */
export function pathOf(points: ArrayLike<number>, closed: boolean): string {
  const pieces: string[] = [];
  for (let k = 0; k + 1 < points.length; k += 2) {
    pieces.push(`${k ? "L" : "M"}${short(points[k]!)} ${short(-points[k + 1]!)}`);
  }
  return pieces.join("") + (closed && pieces.length ? "Z" : "");
}

/** Strokes x, y to x, y, … as one path. */
export function strokesOf(points: ArrayLike<number>): string {
  const pieces: string[] = [];
  for (let k = 0; k + 3 < points.length; k += 4) {
    pieces.push(
      `M${short(points[k]!)} ${short(-points[k + 1]!)}L${short(points[k + 2]!)} ${short(-points[k + 3]!)}`,
    );
  }
  return pieces.join("");
}
