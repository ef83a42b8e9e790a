// Drawing on the canvas: tools, pointer and keys change the file.

import type { FileState, LiveEdit, PalettePart, Picked } from "../../messages";
import type { Mounted } from "../../mount";
import { declareKeys, press, type Command } from "../../keys";
import type { PageData } from "../../page_data";
import { shortNumber, trimmed } from "../../numbers";
import type { Desk } from "../asking";
import type { ForceForms } from "../force_forms";
import { clean } from "../ranges";
import { anchorAt, distance, tidy, type Anchor, type Place, type Places, type Sketch } from "./geometry";
import { Inspector } from "./inspector";
import { KeyPointer } from "./key_pointer";
import { Overlay, pointsWithin } from "./overlay";
import { PART_TOOLS } from "./part_tools";
import { Picking } from "./picking";
import { symbolsAt, type Under } from "./symbols";
import type { Chosen, Expected, Held } from "./selected";
import { ToolBar, TOOLS } from "./tool_bar";
import { removed, shifted, toolEdits } from "./tool_edits";
import { Touches, wheeled } from "./touches";

/** Attraction of points and links [px]: of a mouse, of a finger. */
const REACH = { mouse: 12, touch: 24 };
/** A pointer that moves less has clicked [px]. */
const STILL = 4;
/** Tools that act on a click; with others a line is drawn, or a part is picked. */
const CLICKED: ReadonlySet<string> = new Set(["ground", "drive", "trace"]);
const ARROWS: Readonly<Record<string, Place>> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export interface EditorHooks {
  /** The drawing begins or ends to be edited: all tools do that but "move". */
  readonly mode: (edited: boolean) => void;
  /** The view has changed. */
  readonly viewed: () => void;
  /** Show a short hint. */
  readonly hint: (text: string) => void;
}

interface Gesture {
  readonly start: Anchor;
  readonly reach: number;
  readonly from: Place;
  moved: boolean;
  readonly drag: Places | null;
}

export class Editor {
  readonly tools = new ToolBar((name) => this.choose(name));
  readonly inspector: Inspector;
  private readonly overlay = new Overlay();
  private readonly keyed: KeyPointer;
  private page: Mounted | null = null;
  private file: FileState | null = null;
  private tool = "move";
  private grid = 0;
  private selected: ReadonlySet<string> = new Set();
  private chosen: Chosen | null = null;
  private gesture: Gesture | null = null;
  /** Picks of the part that is being drawn. */
  private picking: Picking | null = null;
  /** The parts before one was drawn, which is then selected. */
  private before: ReadonlySet<string> | null = null;
  private under: Under = {};
  /** What is selected with the next state of the file. */
  private expected: Expected | null = null;
  /** Called after the drawing has been drawn again. */
  redrawn: () => void = () => {};
  private readonly touches = new Touches();
  private gone = new AbortController();

  constructor(
    private readonly desk: Desk,
    forms: ForceForms,
    private readonly hooks: EditorHooks,
  ) {
    this.inspector = new Inspector(desk, forms, () => this.select(null), (chosen) => this.select(chosen));
    this.keyed = new KeyPointer({
      choose: (chosen) => this.select(chosen),
      hint: hooks.hint,
      clicks: () => CLICKED.has(this.tool) || (this.picking !== null && !this.picking.next.sized),
    });
    declareKeys("Drawing", this.commands);
  }

  /** Offer tools for these kinds of parts. */
  offer(parts: readonly PalettePart[]): void {
    this.tools.parts.offer(parts);
    this.inspector.parts.kinds = parts;
  }

  get edited(): boolean {
    return this.tool !== "move";
  }

  /** The tool in use. */
  get inUse(): string {
    return this.tool;
  }

  /** What is selected, for tools that copy it. */
  get held(): Held {
    const { chosen, selected, points, grid } = this;
    return { chosen, selected, points, step: grid / 10, expect: (wanted) => (this.expected = wanted) };
  }

  attach(page: Mounted): void {
    this.gone.abort();
    this.gone = new AbortController();
    this.page = page;
    this.overlay.attach(page);
    this.keyed.attach(page, this.gone.signal);
    const { canvas, drawing } = page.places;
    canvas.append(this.tools.element, this.tools.parts.element, this.tools.parts.prompt, this.inspector.element);
    const options = { capture: true, signal: this.gone.signal };
    const canvasEvents: [string, (event: PointerEvent) => void][] = [
      ["pointerdown", (event) => this.down(event)],
      ["pointermove", (event) => this.move(event)],
      ["pointerup", (event) => this.up(event)],
      ["pointercancel", (event) => this.cancel(event)],
    ];
    for (const [kind, act] of canvasEvents) drawing.element.addEventListener(kind, (event) => act(event as PointerEvent), options);
    drawing.element.addEventListener("wheel", (event) => wheeled(event, drawing), { ...options, passive: false });
    document.addEventListener("keydown", (event) => this.key(event), options);
    drawing.viewed = () => {
      if (this.gesture === null) this.overlay.clear();
      this.redraw();
      this.hooks.viewed();
    };
    this.redraw();
  }

  /** Another state of the file. */
  renew(file: FileState): void {
    this.file = file;
    const drawn = file.form === "points-and-links" && file.readable;
    const edits = TOOLS.map((tool) => tool.name).filter((name) => name !== "move");
    const ready = file.lacks.length === 0;
    const reason = file.readable ? "the points of this file follow from its equations" : "the text cannot be read: correct it under Build";
    if (!drawn) this.tools.disable(edits, reason);
    else this.tools.disable(ready ? [] : ["move"], "this draft does not move yet");
    const known = new Set([...Object.keys(file.points)]);
    this.selected = new Set([...this.selected].filter((name) => known.has(name)));
    const there = { point: known, link: new Set(file.links.map((link) => link.name)), part: new Set(file.parts) };
    if (this.chosen && !there[this.chosen.kind].has(this.chosen.name)) this.chosen = null;
    const added = file.part_entries.find(({ table, name }) => table === this.tool && this.before && !this.before.has(name));
    if (added) this.select({ kind: "part", name: added.name }, this.tool);
    this.inspector.show(this.chosen, file);
    this.take(file);
    this.redraw();
  }

  /** Select what an edit has made. */
  private take(file: FileState): void {
    const { expected } = this;
    this.expected = null;
    if (!expected) return;
    const points = expected.points.filter((name) => name in file.points);
    const there = { point: points, link: file.links.map(({ name }) => name), part: file.parts };
    if (expected.chosen && there[expected.chosen.kind].includes(expected.chosen.name)) this.select(expected.chosen);
    else if (points.length) {
      this.select(null);
      this.selected = new Set(points);
      this.inspector.showMany(points, file);
    }
  }

  /** Begin anew with the tool that changes nothing. */
  rest(): void {
    this.page = null;
    [this.chosen, this.selected, this.tool, this.picking] = [null, new Set(), "move", null];
    this.tools.show("move");
  }

  choose(name: string): void {
    if (name === this.tool) return;
    const before = this.edited;
    this.keyed.rest();
    const part = this.tools.part(name);
    [this.tool, this.before] = [name, null];
    this.picking = part ? new Picking(part, (table, picks) => this.drawn(table, picks)) : null;
    this.tools.show(name);
    if (name !== "select") this.select(null);
    this.overlay.clear();
    if (before !== this.edited) this.hooks.mode(this.edited);
    if (this.picking) this.tell();
    else this.hooks.hint(TOOLS.find((tool) => tool.name === name)!.use);
    this.redraw();
  }

  /** Select a point or link, as a message asks. */
  select(chosen: Chosen | null, tool = "select"): void {
    if (chosen) this.choose(tool);
    [this.chosen, this.before] = [chosen, null];
    const things = chosen?.kind === "link" ? this.file?.links : this.file?.part_entries;
    const own = things?.find((one) => one.name === chosen?.name);
    this.selected = new Set(chosen === null ? [] : chosen.kind === "point" ? [chosen.name] : (own?.points ?? []));
    if (this.file) this.inspector.show(chosen, this.file);
    this.redraw();
  }

  /** Draw grid and selection again, and the paths of another motion. */
  redraw(motion?: PageData | null): void {
    if (this.page === null) return;
    if (motion !== undefined) this.overlay.paths(motion);
    const { drawing } = this.page.places;
    drawing.element.classList.toggle("lw-edited", this.edited);
    this.grid = this.overlay.drawGrid(this.page, this.edited);
    const points = this.points;
    const selected = [...this.selected].flatMap((name) => (points[name] ? [points[name]!] : []));
    const marked = [...selected, ...(this.picking?.places ?? [])];
    this.overlay.select(marked, marked.length ? drawing.pixel : 1); // measured only if needed
    this.keyed.offer(this.page, this.edited ? this.sketch : null, this.tool, this.grid / 10);
    this.redrawn();
  }

  private get points(): Places {
    return this.page?.points ?? {};
  }

  private get sketch(): Sketch {
    return { points: this.points, links: this.file?.links ?? [] };
  }

  private place(event: PointerEvent): Place {
    this.under = symbolsAt(event, this.page!.places.drawing.element, this.file!);
    return this.page!.places.drawing.placeAt(event);
  }

  private reach(event: PointerEvent): number {
    return (event.pointerType === "mouse" ? REACH.mouse : REACH.touch) * this.page!.places.drawing.pixel;
  }

  private anchor(at: Place, reach: number, from?: Place): Anchor {
    const found = anchorAt(this.sketch, at, { reach, grid: this.grid / 10, ...(from ? { from } : {}) });
    const { link } = this.under;
    return link && !found.point && !found.link ? { ...found, link } : found;
  }

  private down(event: PointerEvent): void {
    this.touches.begin(event);
    if (this.touches.count === 2) {
      this.gesture = null;
      this.overlay.clear();
    }
    const panned = event.button === 1 || (this.tool === "move" && this.isFree(event));
    if (!this.edited && !panned && this.touches.count < 2) return;
    event.stopImmediatePropagation();
    event.preventDefault();
    if (event.isTrusted) {
      (document.activeElement as HTMLElement | null)?.blur?.();
      this.page!.places.drawing.element.setPointerCapture(event.pointerId);
    }
    this.touches.panned = panned;
    if (panned || this.touches.count > 1 || event.button !== 0) return;
    const [at, reach] = [this.place(event), this.reach(event)];
    const start = this.anchor(at, reach);
    let drag: Places | null = null;
    if (this.tool === "select") {
      if (start.point && !this.selected.has(start.point)) this.select({ kind: "point", name: start.point });
      else if (!start.point) this.selectUnder(start);
      const held = [...this.selected].flatMap((name) => (this.points[name] ? [[name, this.points[name]!] as const] : []));
      drag = start.point || start.link || this.under.part ? Object.fromEntries(held) : null;
    }
    this.gesture = { start, reach, from: at, moved: false, drag };
    if (this.tool === "link") this.overlay.mark(start.at, start.hint ?? "", this.page!.places.drawing.pixel);
  }

  private isFree(event: PointerEvent): boolean {
    const target = event.target as Element;
    const frame = target.closest("[data-frame]");
    return target === this.page!.places.drawing.element || (frame !== null && !frame.classList.contains("lw-moving"));
  }

  private move(event: PointerEvent): void {
    if (this.page === null || this.touches.moved(event, this.page.places.drawing) || !this.edited) return;
    event.stopImmediatePropagation();
    const { pixel } = this.page.places.drawing;
    const at = this.place(event);
    const gesture = this.gesture;
    if (gesture === null) {
      this.hover(at, this.reach(event), pixel);
      return;
    }
    gesture.moved ||= distance(at, gesture.from) > STILL * pixel;
    if (!gesture.moved) return;
    if (this.tool === "select") this.drag(gesture, at, true);
    else if (this.picking || ["link", "slider", "point"].includes(this.tool)) this.draft(gesture, at, pixel);
  }

  private hover(at: Place, reach: number, pixel: number): void {
    this.overlay.clear();
    if (this.tool === "select") return;
    if (this.picking) {
      const { from, next } = this.picking;
      const found = this.picking.taken(this.anchor(at, reach, from));
      const text = found?.point ?? found?.link ?? "";
      if (found && from && next.takes.includes("place")) this.overlay.preview(from, found.at, text, pixel);
      else if (found) this.overlay.mark(found.at, text, pixel);
      return;
    }
    const found = this.anchor(at, reach);
    const wanted = this.tool === "link" || found.point || (found.link && this.tool !== "ground" && this.tool !== "slider");
    if (wanted) this.overlay.mark(found.at, found.point ?? found.link ?? "", pixel);
  }

  private draft(gesture: Gesture, at: Place, pixel: number): void {
    const { start, reach } = gesture;
    const end = this.end(gesture, at, reach);
    const [dx, dy] = [end.at[0] - start.at[0], end.at[1] - start.at[1]];
    const unit = this.file?.length_unit ?? "";
    if (this.picking?.next.sized) {
      this.overlay.circle(start.at, Math.hypot(dx, dy), this.picking.told(start.at, end.at, unit), pixel);
      return;
    }
    const angle = trimmed(shortNumber((Math.atan2(dy, dx) * 180) / Math.PI, 4));
    const parts = [`${trimmed(shortNumber(Math.hypot(dx, dy), 4))} ${unit}`.trim(), `${angle}°`, end.point ?? end.link ?? end.hint ?? ""];
    this.overlay.preview(start.at, end.at, parts.filter(Boolean).join("  "), pixel);
  }

  private end({ start }: Gesture, at: Place, reach: number): Anchor {
    const found = this.anchor(at, reach, start.at);
    // a point of a link may be placed anywhere, also on the link itself
    return this.tool === "point" ? { at: found.at } : found;
  }

  private drag(gesture: Gesture, at: Place, live: boolean): void {
    if (gesture.drag === null) {
      this.overlay.rubber(gesture.from, at);
      this.selected = new Set(pointsWithin(this.points, gesture.from, at));
      this.redraw();
      return;
    }
    const names = Object.keys(gesture.drag);
    const step = this.grid / 10;
    const snapped = anchorAt(this.sketch, at, { reach: 0, grid: step, except: new Set(names) });
    const by: Place = [snapped.at[0] - gesture.start.at[0], snapped.at[1] - gesture.start.at[1]];
    const places = Object.fromEntries(
      names.map((name) => [name, gesture.drag![name]!.map((c, k) => clean(tidy(c + by[k]!, step))) as [number, number]] as const),
    );
    const edit = { kind: "move_points", places, keep: this.inspector.locked } as const;
    if (live) this.desk.latest({ ...edit, live });
    else this.desk.ask(edit);
  }

  private up(event: PointerEvent): void {
    this.touches.end(event);
    const gesture = this.gesture;
    this.gesture = null;
    this.overlay.clear();
    if (!this.edited || gesture === null) return;
    event.stopImmediatePropagation();
    const at = this.place(event);
    if (this.tool === "select") this.dropped(gesture, at);
    else this.made(gesture, at);
  }

  private dropped(gesture: Gesture, at: Place): void {
    if (gesture.moved) this.drag(gesture, at, false);
    else if (gesture.start.point) this.select({ kind: "point", name: gesture.start.point });
    else if (!gesture.start.link && !this.under.part) this.select(null);
    if (gesture.moved && gesture.drag === null) this.inspector.showMany([...this.selected], this.file!);
  }

  /** The edit made by a click or a drag with a tool. */
  private made(gesture: Gesture, at: Place): void {
    const { start, reach, moved } = gesture;
    const end = this.end(gesture, at, reach);
    if (this.picking) {
      this.select(null);
      const possible = this.picking.pick(start, moved ? end : null);
      this.tell(possible ? "" : "Not here. ");
      this.redraw();
      return;
    }
    const edits = toolEdits(this.tool, this.file!, { start, end, moved, part: this.under.part, span: 4 * this.grid });
    if (typeof edits === "string") this.hooks.hint(edits);
    else this.send(edits);
  }

  /** Select the symbol or link under the pointer. */
  private selectUnder({ link }: Anchor): void {
    const { part } = this.under;
    if (part) this.select({ kind: "part", name: part });
    else if (link) this.select({ kind: "link", name: link });
  }

  /** Tell what to pick next. */
  private tell(before = ""): void {
    if (!this.picking) return;
    this.hooks.hint(before + this.picking.prompt);
    this.tools.parts.tell(before + this.picking.prompt);
  }

  /** A part was picked; it is selected when it is there. */
  private drawn(table: string, picks: readonly Picked[]): void {
    this.before = new Set(this.file!.parts);
    this.desk.ask({ kind: "draw_part", table, picks, span: 4 * this.grid });
  }

  private send(edits: readonly LiveEdit[]): void {
    if (edits.length) this.desk.ask(edits.length === 1 ? edits[0]! : { kind: "together", edits });
  }

  private cancel(event: PointerEvent): void {
    this.touches.end(event);
    this.gesture = null;
    this.overlay.clear();
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (this.page === null) return;
    if (document.querySelector("dialog[open]")) return; // its keys are its own
    if (target.closest("input, textarea, select") && event.key !== "Escape") return;
    if (target.closest(".lw-part-tools") && event.key === "Escape") return;
    if (event.key === "Enter" && target !== document.body) return; // it presses what has the focus
    if (press(this.commands, event)) event.stopImmediatePropagation();
  }

  private readonly commands: readonly Command[] = [
    ...[...TOOLS, ...PART_TOOLS].map(({ name, key, title }) => ({ keys: [key], does: title, act: () => this.tools.press(name) })),
    { keys: ["Enter"], does: "End what is picked point by point", when: () => this.picking?.next.repeated === true, act: () => this.picking!.finish() && this.tell() },
    { keys: ["f"], does: "See the whole mechanism", act: () => this.page!.places.drawing.see(null) },
    { keys: ["Escape"], does: "Drop what is begun; select nothing", when: () => this.edited, act: () => this.escape() },
    { keys: ["Delete", "Backspace"], does: "Delete the selection", when: () => this.selected.size > 0 || this.chosen !== null, act: () => this.remove() },
    {
      keys: Object.keys(ARROWS),
      does: "Move the selection; with Shift ten times as far",
      when: () => this.tool === "select" && this.selected.size > 0 && this.keyed.idle,
      act: (event) => this.shift(ARROWS[event.key]!, event.shiftKey),
    },
  ];

  /** Move the selected points by a step of the grid. */
  private shift([dx, dy]: Place, far: boolean): void {
    const step = (this.grid / 10) * (far ? 10 : 1);
    const places = shifted(this.points, this.selected, [dx * step, dy * step]);
    this.desk.ask({ kind: "move_points", places, keep: this.inspector.locked });
  }

  private escape(): void {
    this.gesture = null;
    this.keyed.rest();
    this.picking?.cancel();
    this.tell();
    this.overlay.clear();
    this.select(null);
  }

  /** Remove the selected link or points. */
  private remove(): void {
    this.send(removed(this.chosen, this.selected));
    this.select(null);
  }
}

