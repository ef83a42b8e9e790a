// The force polygon of a link: the forces of its pins head to tail, closed by all other forces.

import { forcesOn, forceUnit, loadedLinks, type PinForce } from "./forces";
import type { MotionView } from "./motion";
import { measured } from "./numbers";
import { html, pathOf, put, say, svg } from "./svg";

const SIDE = 240; // the picture [units]
const MARGIN = 34;
const HEAD = 9;
const NAME = 12;

type Corner = readonly [number, number];

/** Corners of the polygon in a row: the beginning of the first force, then all tips. */
export function cornersOf(forces: readonly PinForce[], row: number): Corner[] {
  const corners: Corner[] = [[0, 0]];
  for (const { at } of forces) {
    const [x, y] = at(row);
    const [px, py] = corners[corners.length - 1]!;
    corners.push([px + x, py + y]);
  }
  return corners;
}

/** A box that opens with the polygon; hidden without forces. */
export class ForcePolygon {
  readonly element: HTMLDetailsElement;
  private readonly choice: HTMLSelectElement;
  private readonly picture: SVGSVGElement;
  private readonly note: HTMLElement;
  private view: MotionView | null = null;
  private forces: readonly PinForce[] = [];
  private row = -1;

  constructor(parent: Element) {
    this.element = html("details", { class: "lw-polygon", hidden: "" }, parent);
    html("summary", {}, this.element, "Force polygon");
    const label = html("label", {}, this.element, "of ");
    this.choice = html("select", { "aria-label": "Link of the force polygon" }, label);
    this.picture = svg("svg", { viewBox: `0 0 ${SIDE} ${SIDE}`, role: "img" }, this.element);
    this.note = html("p", { class: "lw-polygon-note" }, this.element);
    this.choice.addEventListener("change", () => this.choose());
    this.element.addEventListener("toggle", () => this.draw(this.row));
  }

  show(view: MotionView): void {
    this.view = view;
    const links = loadedLinks(view);
    this.element.hidden = links.length === 0;
    const before = this.choice.value;
    if (links.join() !== Array.from(this.choice.options, ({ value }) => value).join()) {
      this.choice.replaceChildren();
      for (const link of links) html("option", { value: link }, this.choice, link);
      if (links.includes(before)) this.choice.value = before;
    }
    this.choose();
  }

  private choose(): void {
    this.forces = this.view && this.choice.value ? forcesOn(this.view, this.choice.value) : [];
    this.draw(this.row);
  }

  draw(row: number): void {
    this.row = row;
    if (!this.view || row < 0 || this.element.hidden || !this.element.open) return;
    this.picture.replaceChildren();
    const corners = cornersOf(this.forces, row);
    const known = corners.every(([x, y]) => Number.isFinite(x + y));
    if (!known || !this.forces.length) {
      say(this.note, "The forces are not determined here.");
      put(this.picture, { "aria-label": "no forces" });
      return;
    }
    const [xs, ys] = [corners.map(([x]) => x), corners.map(([, y]) => y)];
    const [left, right, bottom, top] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const scale = (SIDE - 2 * MARGIN) / (Math.max(right - left, top - bottom) || 1);
    const [cx, cy] = [(left + right) / 2, (bottom + top) / 2];
    const placed = corners.map(([x, y]): Corner => [SIDE / 2 + scale * (x - cx), SIDE / 2 + scale * (cy - y)]);
    const unit = forceUnit(this.view);
    this.forces.forEach(({ name, at }, k) => this.arrow(placed[k]!, placed[k + 1]!, name, "lw-force", `${name} = ${measured(Math.hypot(...at(row)), unit)}`));
    const [last, first] = [placed[placed.length - 1]!, placed[0]!];
    const [x, y] = corners[corners.length - 1]!;
    const rest = Math.hypot(x, y);
    if (rest * scale > 1) this.arrow(last, first, "rest", "lw-force lw-rest", `rest = ${measured(rest, unit)}`);
    const sizes = this.forces.map(({ name, at }) => `${name} = ${measured(Math.hypot(...at(row)), unit)}`);
    const text = `${sizes.join(", ")}; rest ${measured(rest, unit)}: inertia, weight, loads and guides`;
    say(this.note, text);
    put(this.picture, { "aria-label": `Force polygon of ${this.choice.value}: ${text}` });
  }

  private arrow([x0, y0]: Corner, [x1, y1]: Corner, name: string, look: string, title: string): void {
    const length = Math.hypot(x1 - x0, y1 - y0);
    if (length < 0.5) return;
    const group = svg("g", { class: look }, this.picture);
    svg("title", {}, group).textContent = title;
    const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length];
    const head = Math.min(HEAD, length / 2);
    const [bx, by] = [x1 - head * ux, y1 - head * uy];
    // Pictures have y downwards, paths of this front end upwards.
    svg("path", { class: "shaft", d: pathOf([x0, -y0, bx, -by], false) }, group);
    svg("path", { class: "head", d: pathOf([x1, -y1, bx - 0.4 * head * uy, -by - 0.4 * head * ux, bx + 0.4 * head * uy, -by + 0.4 * head * ux], true) }, group);
    const [mx, my] = [(x0 + x1) / 2 - NAME * uy, (y0 + y1) / 2 + NAME * ux];
    const text = svg("text", { x: Math.min(SIDE - 14, Math.max(14, mx)), y: my + 4, "text-anchor": "middle" }, group);
    text.textContent = name;
  }
}
