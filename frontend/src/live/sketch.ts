// The points of the sketch over the drawing, moved with the pointer or arrow keys.

import type { FileState, PointMoved } from "../messages";
import type { Mounted } from "../mount";
import { html, svg } from "../svg";
import type { Desk } from "./asking";
import { clean, roundStep } from "./ranges";
import { drawLinks } from "./schematic";

const ARROWS: Readonly<Record<string, readonly [number, number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

export class Sketch {
  readonly switch = html("label", { class: "lw-toggle", title: "Show the sketch of the file and move its points" });
  private readonly box = html("input", { type: "checkbox" }, this.switch);
  private readonly group = svg("g", { class: "lw-sketch" });
  private readonly links = svg("g", {}, this.group);
  private readonly handles = svg("g", {}, this.group);
  private page: Mounted | null = null;
  private held: string | null = null;
  private shown = false;

  constructor(private readonly desk: Desk) {
    this.switch.append("Move points");
    this.box.addEventListener("change", () => this.renew());
  }

  attach(page: Mounted): void {
    this.page = page;
    page.places.toggles.insertBefore(this.switch, page.places.toggles.querySelector(".lw-hint"));
    page.places.drawing.element.append(this.group);
    this.switch.hidden = Object.keys(this.desk.file().points).length === 0;
  }

  /** Draw the sketch as in the file, unless a point is being dragged. */
  renew(): void {
    const page = this.page;
    if (page === null || this.held !== null) return;
    const on = this.box.checked;
    const file = this.desk.file();
    this.switch.hidden = Object.keys(file.points).length === 0;
    if (on || this.handles.childElementCount) page.places.drawing.dim(on);
    if (on) page.goToInput(page.input); // it stands still
    const focused = (document.activeElement as Element | null)?.getAttribute("data-sketched");
    this.links.replaceChildren();
    this.handles.replaceChildren();
    if (on || this.shown) page.places.drawing.include("sketch", on ? Object.values(file.points) : []);
    this.shown = on;
    if (!on || this.switch.hidden) return;
    const stroke = this.stroke();
    drawLinks(this.links, file.links, file.points, { stroke, names: 13 * stroke });
    for (const [name, place] of Object.entries(file.points)) this.handle(file, name, place, stroke);
    if (focused) this.handles.querySelector<SVGElement>(`[data-sketched="${CSS.escape(focused)}"]`)?.focus();
  }

  /** A message about the lengths that followed a point. */
  told(moved: PointMoved): string {
    const { point, followed, stayed } = moved;
    const parts = [`${point} was moved in the sketch.`];
    if (followed.length) parts.push(`${listed(followed)} followed.`);
    if (stayed.length) parts.push(`${listed(stayed)} stayed: given by a formula.`);
    return parts.join(" ");
  }

  private stroke(): number {
    const matrix = this.page!.places.drawing.element.getScreenCTM();
    return matrix ? 1 / matrix.a : 1;
  }

  private handle(file: FileState, name: string, [x, y]: readonly [number, number], stroke: number): void {
    const handle = svg(
      "circle",
      { class: "lw-sketched", "data-sketched": name, cx: x, cy: -y, r: 11 * stroke, tabindex: 0, role: "button" },
      this.handles,
    );
    handle.setAttribute("aria-label", `Point ${name} of the sketch, at ${x}, ${y}: arrow keys move it`);
    const place: [number, number] = [x, y];
    const move = (live: boolean): void => {
      const request = { kind: "move_point", point: name, x: clean(place[0]), y: clean(place[1]), lengths_follow: true } as const;
      if (live) this.desk.latest({ ...request, live });
      else this.desk.ask(request);
      handle.setAttribute("cx", String(place[0]));
      handle.setAttribute("cy", String(-place[1]));
      drawLinks(this.links, file.links, { ...file.points, [name]: place }, { stroke, names: 13 * stroke });
    };
    handle.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      event.stopPropagation();
      this.held = name;
      handle.setPointerCapture(event.pointerId);
    });
    handle.addEventListener("pointermove", (event) => {
      if (this.held !== name) return;
      [place[0], place[1]] = this.page!.places.drawing.placeAt(event);
      move(true);
    });
    for (const end of ["pointerup", "pointercancel"] as const) {
      handle.addEventListener(end, () => {
        if (this.held !== name) return;
        this.held = null;
        if (place[0] !== x || place[1] !== y) move(false);
      });
    }
    handle.addEventListener("keydown", (event) => {
      const by = ARROWS[event.key];
      if (by === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      const step = roundStep(stroke * (event.shiftKey ? 40 : 8));
      place[0] += by[0] * step;
      place[1] += by[1] * step;
      move(false);
    });
  }
}

function listed(names: readonly string[]): string {
  return names.length > 4 ? `${names.slice(0, 4).join(", ")} and ${names.length - 4} more lengths` : names.join(", ");
}
