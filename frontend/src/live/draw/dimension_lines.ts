// Lengths as dimension lines on the drawing; a click on a number opens it for typing.

import type { ChangeableNumber, FileState } from "../../messages";
import type { Mounted } from "../../mount";
import { shortNumber, trimmed } from "../../numbers";
import { html, pathOf, put, svg } from "../../svg";
import type { Desk } from "../asking";
import { typed } from "../ranges";
import { centreOf } from "./copies";
import { distance, type Place, type Places } from "./geometry";
import { iconButton } from "./icon_button";

/** Distance of a line from what it measures, of its ends, its arrows, its text [px]. */
const AWAY = 26;
const BEYOND = 5;
const ARROW = 8;
const TEXT = 13;

/** The two ends of a dimension line, on the side away from the centre of the drawing. */
export function lineOf(a: Place, b: Place, centre: Place, away: number): [Place, Place] {
  const length = distance(a, b) || 1;
  const [u, v] = [-(b[1] - a[1]) / length, (b[0] - a[0]) / length];
  const side = (a[0] + b[0] - 2 * centre[0]) * u + (a[1] + b[1] - 2 * centre[1]) * v < 0 ? -away : away;
  return [
    [a[0] + side * u, a[1] + side * v],
    [b[0] + side * u, b[1] + side * v],
  ];
}

export class DimensionLines {
  readonly button = iconButton("Dimensions on the drawing", "Dimensions on the drawing while it is edited; a click opens a number", "M4 5v14M20 5v14M5 12h14M8.500 8.500L5 12l3.500 3.500M15.500 8.500L19 12l-3.500 3.500");
  private readonly group = svg("g", { class: "lw-dimension-lines" });
  private readonly field = html("input", { type: "text", class: "lw-dimension-field", autocomplete: "off", spellcheck: "false", hidden: "" });
  private page: Mounted | null = null;
  private on = false;
  private open: ChangeableNumber | null = null;

  constructor(
    private readonly desk: Desk,
    private readonly edited: () => boolean,
  ) {
    this.button.addEventListener("click", () => {
      this.on = !this.on;
      put(this.button, { "aria-pressed": String(this.on) });
      this.draw();
    });
    this.field.addEventListener("change", () => this.enter());
    this.field.addEventListener("blur", () => this.close());
    this.field.addEventListener("keydown", (event) => event.key === "Escape" && this.close());
    this.field.addEventListener("pointerdown", (event) => event.stopPropagation());
  }

  attach(page: Mounted): void {
    this.page = page;
    page.places.drawing.element.append(this.group);
    page.places.canvas.append(this.field);
    this.draw();
  }

  /** Whether the number under the pointer was opened. */
  press(event: Event): boolean {
    const name = (event.target as Element).closest<SVGElement>("[data-dimension]")?.dataset.dimension;
    const number = this.desk.file().numbers.find((one) => one.name === name);
    if (!number) return false;
    this.begin(number, (event.target as Element).getBoundingClientRect());
    return true;
  }

  draw(): void {
    if (this.page === null) return;
    const shown = this.on && this.edited();
    this.group.replaceChildren();
    if (!shown) return;
    const { points, places } = this.page;
    const centre = centreOf(Object.values(points));
    for (const number of lengthsOf(this.desk.file())) this.line(number, points, centre, places.drawing.pixel);
  }

  private line(number: ChangeableNumber, points: Places, centre: Place, pixel: number): void {
    const [a, b] = number.name.split(" ").map((name) => points[name]) as [Place | undefined, Place | undefined];
    if (!a || !b || distance(a, b) < 2 * ARROW * pixel) return;
    const [p, q] = lineOf(a, b, centre, AWAY * pixel);
    const given = number.table === "lengths" ? "" : " lw-dimension-measured";
    const one = svg("g", { class: `lw-dimension${given}`, "data-dimension": number.name }, this.group);
    const far = lineOf(a, b, centre, (AWAY + BEYOND) * pixel);
    svg("path", { d: [pathOf([...a, ...far[0]], false), pathOf([...b, ...far[1]], false), pathOf([...p, ...q], false)].join("") }, one);
    const [u, v] = [(q[0] - p[0]) / distance(p, q), (q[1] - p[1]) / distance(p, q)];
    for (const [[x, y], sense] of [[p, 1], [q, -1]] as const) {
      const [bx, by] = [x + sense * ARROW * pixel * u, y + sense * ARROW * pixel * v];
      const wide = 0.18 * ARROW * pixel;
      svg("path", { class: "lw-dimension-arrow", d: pathOf([x, y, bx - wide * v, by + wide * u, bx + wide * v, by - wide * u], true) }, one);
    }
    const text = svg("text", { x: (p[0] + q[0]) / 2, y: -(p[1] + q[1]) / 2, "text-anchor": "middle", dy: "0.35em", tabindex: 0, role: "button" }, one);
    const shown = trimmed(shortNumber(number.value, 5));
    text.textContent = shown;
    text.style.fontSize = `${TEXT * pixel}px`;
    text.style.strokeWidth = `${5 * pixel}px`;
    text.setAttribute("aria-label", `${number.name} = ${shown} ${number.unit}`);
    text.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && this.press(event)) event.preventDefault();
    });
  }

  /** A field over the number. */
  private begin(number: ChangeableNumber, box: DOMRect): void {
    const canvas = this.page!.places.canvas.getBoundingClientRect();
    this.open = number;
    this.field.hidden = false;
    this.field.setAttribute("aria-label", `${number.name} [${number.unit}]`);
    this.field.value = number.formula || trimmed(shortNumber(number.value));
    this.field.style.left = `${box.left + box.width / 2 - canvas.left}px`;
    this.field.style.top = `${box.top + box.height / 2 - canvas.top}px`;
    this.field.focus();
    this.field.select();
  }

  private enter(): void {
    const { open } = this;
    if (open && this.field.value.trim()) this.desk.ask({ kind: "set_number", name: open.name, value: typed(this.field.value), any_formula: true });
    this.close();
  }

  private close(): void {
    this.open = null;
    this.field.hidden = true;
  }
}

/** Given lengths, and those of links that are measured in the sketch. */
function lengthsOf(file: FileState): ChangeableNumber[] {
  return file.numbers.filter(({ table }) => table === "lengths" || table === "measured");
}
