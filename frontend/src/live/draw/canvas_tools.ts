// Tools beside those that draw: zoom, measure, dimension lines, a photograph, copies.

import { declareKeys, press, type Command } from "../../keys";
import type { Mounted } from "../../mount";
import { put } from "../../svg";
import type { Desk } from "../asking";
import { DimensionLines } from "./dimension_lines";
import type { Editor } from "./editor";
import { iconButton } from "./icon_button";
import { Measure } from "./measure";
import { Photograph } from "./photograph";
import { Selected } from "./selected";
import { Zoom } from "./zoom";

export class CanvasTools {
  private readonly zoom = new Zoom();
  private readonly selected: Selected;
  private readonly measure: Measure;
  private readonly lines: DimensionLines;
  private readonly photograph: Photograph;
  private readonly ruler = iconButton("Measure", "Measure (Q): two clicks a distance, three an angle", "M3 15.500L15.500 3 21 8.500 8.500 21zM7 12l2.500 2.500M10.500 8.500l2 2M14 5l2.500 2.500");
  private gone = new AbortController();
  private readonly commands: readonly Command[];

  constructor(desk: Desk, editor: Editor) {
    this.selected = new Selected(desk, () => editor.held);
    this.measure = new Measure(desk, () => put(this.ruler, { "aria-pressed": String(this.measure.on) }));
    this.lines = new DimensionLines(desk, () => editor.edited);
    this.photograph = new Photograph(desk);
    put(this.ruler, { "aria-keyshortcuts": "Q" });
    this.ruler.addEventListener("click", () => this.measure.set(!this.measure.on));
    this.zoom.element.append(this.ruler, this.lines.button, this.photograph.button);
    this.commands = [
      { keys: ["d"], ctrl: true, does: "Duplicate the selection", act: () => this.selected.duplicate() },
      { keys: ["q"], does: "Measure: two clicks a distance, three an angle", act: () => this.measure.set(!this.measure.on) },
      { keys: ["Escape"], does: "End measuring", when: () => this.measure.on, act: () => this.measure.set(false) },
      ...this.zoom.commands,
    ];
    declareKeys("View and copies", this.commands);
    editor.inspector.more = (panel) => this.selected.fill(panel);
    editor.redrawn = () => this.draw();
  }

  attach(page: Mounted): void {
    this.gone.abort();
    this.gone = new AbortController();
    const options = { capture: true, signal: this.gone.signal };
    this.zoom.attach(page);
    this.photograph.attach(page, this.gone.signal);
    this.lines.attach(page);
    this.measure.attach(page);
    document.addEventListener("keydown", (event) => this.key(event), options);
    page.places.canvas.addEventListener("pointerdown", (event) => this.press(event, page), options);
  }

  /** Draw again what is over and behind the mechanism. */
  draw(): void {
    this.photograph.renew();
    this.lines.draw();
    this.measure.draw();
  }

  /** Another position of the mechanism. */
  moved(): void {
    if (this.measure.on) this.measure.draw();
  }

  /** A pointer on the drawing that one of these tools takes. */
  private press(event: PointerEvent, page: Mounted): void {
    if (event.button !== 0 || !page.places.drawing.element.contains(event.target as Node)) return;
    const taken = this.photograph.press(event) || this.lines.press(event) || this.measure.on;
    if (!taken) return;
    event.stopPropagation();
    event.preventDefault();
    if (this.measure.on) this.measure.click(event);
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (document.querySelector("dialog[open]") || target.closest("input, textarea, select")) return;
    if (press(this.commands, event)) event.stopImmediatePropagation();
  }
}
