// The front end mounted by offline pages, the live page and the notebook widget.

import { ArrowSets } from "./arrow_sets";
import { ForcePolygon } from "./force_polygon";
import { Charts } from "./charts";
import { toggle, Transport } from "./controls";
import { stepTowards, type Step } from "./drag";
import { Drawing } from "./drawing";
import { keepFitted } from "./equation_size";
import { Ghost, sameInput } from "./ghost";
import { InWords } from "./in_words";
import { declareKeys, press, showKeys, type Command } from "./keys";
import { MotionView } from "./motion";
import { MotionNumbers } from "./motion_numbers";
import { measured } from "./numbers";
import type { MotionData, PageData } from "./page_data";
import { Player } from "./player";
import { Presentation } from "./presentation";
import { Questions } from "./questions";
import { Slowly } from "./slowly";
import { html, put, say } from "./svg";
import { RowTable } from "./table";
import { themeButton } from "./theme_button";
import { themeRules } from "./theme";

export type { PageData } from "./page_data";

/** The format of page data of this front end. */
export const FORMAT = 1;

export interface Hooks {
  /** Called when a row is shown. */
  readonly row?: (motion: number, row: number) => void;
  /** Do not start automatically. */
  readonly still?: boolean;
  /** Embedded in a page: keys work only while the focus is inside. */
  readonly embedded?: boolean;
  /** The design can be changed. */
  readonly changing?: boolean;
}

/** The mounted front end. */
export interface Mounted {
  /** Show other data at the same input; `steady` keeps the view, during a drag. */
  update(data: PageData, steady?: boolean): void;
  /** Show a row of the table. */
  goToRow(row: number): void;
  /** Show the row with the nearest input. */
  goToInput(value: number): void;
  /** The input of the displayed row. */
  readonly input: number;
  /** The coordinates of all points in the displayed row. */
  readonly points: Readonly<Record<string, readonly [number, number]>>;
  /** Start or stop the motion. */
  play(on: boolean): void;
  /** The displayed row of the table. */
  readonly row: number;
  /** All quantities of the displayed row. */
  readonly values: Readonly<Record<string, number>>;
  readonly charts: Charts;
  /** Whether rates of points are shown, which the updates of a drag otherwise lack. */
  readonly rates: boolean;
  /** The elements that accept additions. */
  readonly places: Places;
  readonly presentation: Presentation;
  /** Show a row of a motion by number; if it has no position, the first found row. */
  goTo(motion: number, row: number): void;
  destroy(): void;
}

/** Elements of the mounted front end. */
export interface Places {
  readonly head: HTMLElement;
  readonly stage: HTMLElement;
  readonly canvas: HTMLElement;
  readonly side: HTMLElement;
  readonly toggles: HTMLElement;
  readonly drawing: Drawing;
}

/** Words about a motion that plays are renewed so often [ms]. */
const SPOKEN_EVERY = 3000;

/** Maximum interval of updates during a drag [ms]. */
const UPDATED_WITHIN = 120;

/** Without updates for so many of their intervals, a drag rests: everything is drawn. */
const RESTS_AFTER = 3;

let mounted = 0;

/** Show a motion in an element. */
export function mount(element: HTMLElement, data: PageData, hooks: Hooks = {}): Mounted {
  return new Page(element, checked(data), hooks);
}

/** The box around two boxes. */
function around(one: readonly number[], other: readonly number[]): number[] {
  return one.map((side, k) => (k < 2 ? Math.min : Math.max)(side, other[k]!));
}

/** A motion with its previous vectors between points, if the new data has none. */
function withVectors(motion: MotionData, before: MotionData | undefined): MotionData {
  if (motion.vectors.length || !before) return motion;
  return { ...motion, vectors: before.vectors.filter(({ course }) => !course.length) };
}

function checked(data: PageData): PageData {
  if (data.format === FORMAT) return data;
  throw new Error(`this front end reads page data of format ${FORMAT}, not ${data.format}`);
}

class Page implements Mounted {
  private readonly root: HTMLElement;
  private readonly style = new CSSStyleSheet();
  private rules = "";
  readonly places: Places;
  private readonly drawing: Drawing;
  private readonly arrows: ArrowSets;
  private readonly transport: Transport;
  readonly charts: Charts;
  /** The design before, in pale lines: pinned, or that at the beginning of a drag. */
  private past: MotionView | null = null;
  private pinned = false;
  private readonly ghost: Ghost;
  private readonly whole: MotionNumbers;
  private readonly polygon: ForcePolygon;
  private readonly table: RowTable;
  private readonly player: Player;
  private readonly live: HTMLElement;
  private choice: HTMLSelectElement | null = null;
  private summary!: HTMLElement;
  private title!: HTMLElement;
  private equationBox!: HTMLElement;
  presentation!: Presentation;
  private readonly words: InWords;
  private readonly questions: Questions;
  private readonly reword = new Slowly(SPOKEN_EVERY, () => this.describe());
  /** Whether rates of points were shown before this update of a drag. */
  private rated = false;
  private views: (MotionView | undefined)[] = [];
  private motion = 0;
  private frame = 0;
  private last = 0;
  private drawn = -1;
  /** When the last update of a drag came, and after what time [ms]. */
  private steady = -Infinity;
  private pace = 0;
  private updates = 0;
  /** Whose turn it is during a drag: a chart by its number, or the numbers; null: everything. */
  private turn: number | null = null;
  private spoken = 0;
  private readonly gone = new AbortController();
  private readonly sized = new ResizeObserver(() => this.drawing.resized());

  constructor(
    element: HTMLElement,
    private data: PageData,
    private readonly hooks: Hooks,
  ) {
    this.root = html("div", { class: hooks.embedded ? "lw" : "lw lw-full", id: `lw-${++mounted}`, tabindex: -1 });
    element.replaceChildren(this.root);
    this.adopt();
    const head = this.heading();
    const stage = html("section", { class: "lw-stage", "aria-label": "Drawing" }, this.root);
    const canvas = html("div", { class: "lw-canvas" }, stage);
    this.drawing = new Drawing(data, canvas);
    this.ghost = new Ghost(data, this.drawing.element);
    this.arrows = new ArrowSets(data, this.drawing, canvas);
    this.player = new Player(1, true);
    this.transport = new Transport(stage, {
      play: (on) => this.player.play(on),
      go: (index) => this.hold(index),
      speed: (factor) => (this.player.speed = factor),
    });
    const toggles = this.toggles(stage);
    this.words = new InWords(toggles, this.drawing.element, () => this.describe());
    const side = html("section", { class: "lw-side", "aria-label": "Numbers" }, this.root);
    this.questions = new Questions(this.root, () => this.describe());
    side.append(this.questions.element);
    const facts = html("div", { class: "lw-facts" }, side);
    this.charts = new Charts(hooks.embedded ? side : this.root, this.plotted(), (index) => this.hold(index));
    this.table = new RowTable(facts, 1e-10 * (data.view[2]! - data.view[0]!));
    this.whole = new MotionNumbers(facts);
    this.polygon = new ForcePolygon(facts);
    this.equationBox = html("div", {}, facts);
    keepFitted(this.equationBox, this.gone.signal);
    this.equations();
    this.layOut();
    this.places = { head, stage, canvas, side, toggles, drawing: this.drawing };
    this.live = html("div", { class: "lw-unseen", role: "status", "aria-live": "polite" }, this.root);
    this.player.onChange(() => this.draw());
    this.listen();
    this.show(0, 0);
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (!hooks.still && !calm) this.player.play(true);
    this.frame = requestAnimationFrame((now) => this.tick(now));
  }

  update(data: PageData, steady = false): void {
    if (steady) this.pass(performance.now(), false);
    const here = this.input;
    const index = this.player.at;
    const { view, stroke, pin, text, motions } = this.data;
    if (!this.pinned) this.past = steady ? (this.past ?? this.view) : null;
    this.data = checked(data);
    if (steady) {
      const kept = data.motions.map((motion, k) => withVectors(motion, motions[k]));
      this.data = { ...data, view: around(view, data.view), stroke, pin, text, motions: kept };
      const now = performance.now();
      this.pace = Math.min(UPDATED_WITHIN, Math.max(UPDATED_WITHIN / RESTS_AFTER, now - this.steady));
      this.steady = now;
    }
    this.rated = steady && this.rates;
    this.views = [];
    if (!steady) this.dress();
    if (!steady) this.layOut();
    say(this.title, data.title);
    this.drawing.renew(this.data);
    this.arrows.renew(this.data);
    if (data.equations.length) this.equations();
    this.motion = Math.min(this.motion, data.motions.length - 1);
    this.show(this.motion, this.nearest(here, index), steady);
  }

  get input(): number {
    return this.view.input.values[this.view.order[this.player.at]!]!;
  }

  get points(): Record<string, readonly [number, number]> {
    const row = this.row;
    return Object.fromEntries(this.view.points.map(({ name, x, y }) => [name, [x[row]!, y[row]!] as const]));
  }

  get rates(): boolean {
    return this.rated || this.views.some((view) => view?.ratesRead);
  }

  play(on: boolean): void {
    this.player.play(on);
  }

  get row(): number {
    const { order } = this.view;
    return order[Math.min(this.player.at, order.length - 1)]!;
  }

  get values(): Record<string, number> {
    const { row } = this;
    return Object.fromEntries(this.view.series.map((one) => [one.name, one.values[row]!]));
  }

  goToInput(value: number): void {
    this.hold(this.nearest(value, this.player.at));
  }

  goToRow(row: number): void {
    const index = this.view.order.indexOf(row);
    if (index >= 0) this.hold(index);
  }

  goTo(motion: number, row: number): void {
    if (motion !== this.motion) this.show(motion, 0);
    const index = Math.max(0, this.view.order.indexOf(row));
    if (index !== this.player.at) this.hold(index);
  }

  destroy(): void {
    this.gone.abort();
    this.sized.disconnect();
    const sheets = this.sheets();
    sheets.adoptedStyleSheets = sheets.adoptedStyleSheets.filter((sheet) => sheet !== this.style);
    cancelAnimationFrame(this.frame);
    this.charts.destroy();
    this.root.remove();
  }

  private get view(): MotionView {
    return (this.views[this.motion] ??= new MotionView(this.data.motions[this.motion]!, this.data));
  }

  /** Show a motion, starting at one of its rows; `rests`: whether a drag has stopped for a while. */
  private show(motion: number, index: number, steady = false, rests = false): void {
    this.motion = motion;
    const view = this.view;
    this.drawn = -1;
    if (this.data.motions.length > 1) this.drawing.renew({ ...this.data, view: view.data.view });
    this.drawing.show(view, steady && !rests, this.past);
    put(this.drawing.element, { "aria-label": this.data.title || "mechanism" });
    this.ghost.show(this.past);
    this.arrows.show(view);
    this.transport.show(view);
    const still = view.series.length === 0;
    if (!still) this.questions.show(this.data, view.data, steady);
    // During a drag every chart and the numbers have their turn.
    this.turn = steady && !rests ? this.updates++ % (this.charts.count + 1) : null;
    if (!still) this.charts.show(view, this.past, steady, this.turn);
    if (!still && this.numbered) {
      this.table.show(view);
      this.whole.show(view, steady);
      this.polygon.show(view);
    }
    this.root.classList.toggle("lw-still", still);
    this.root.classList.toggle("lw-in-time", view.times !== null);
    say(this.summary, view.data.summary);
    if (this.choice) this.choice.selectedIndex = motion;
    this.player.restart(view.order.length, view.data.closed, index, view.times);
  }

  private get numbered(): boolean {
    return this.turn === null || this.turn === this.charts.count;
  }

  /** Show everything that waited for its turn during a drag. */
  private settle(): void {
    this.steady = -Infinity;
    this.show(this.motion, this.player.at, true, true);
  }

  /** Show another motion, at the current input if it reaches this. */
  private choose(motion: number): void {
    const here = this.input;
    this.motion = motion;
    this.show(motion, this.nearest(here, 0));
    this.speak();
  }

  /** The index with the nearest input; among equals, the one nearest to an index. */
  private nearest(value: number, index: number): number {
    const { input, order } = this.view;
    const turn = { deg: 360, rad: 2 * Math.PI }[input.unit];
    const far = order.map((row) => {
      const off = input.values[row]! - value;
      // One turn further, an angle is the same; the same turn is preferred.
      return turn ? Math.abs(off - turn * Math.round(off / turn)) + 1e-6 * Math.abs(off) : Math.abs(off);
    });
    const least = Math.min(...far) * (1 + 1e-9) + 1e-12;
    const alike = far.flatMap((one, k) => (one <= least ? [k] : []));
    return alike.reduce((best, k) => (Math.abs(k - index) < Math.abs(best - index) ? k : best), alike[0] ?? 0);
  }

  /** The colours, as a style sheet allowed by any content security policy. */
  private adopt(): void {
    this.dress();
    const sheets = this.sheets();
    sheets.adoptedStyleSheets = [...sheets.adoptedStyleSheets, this.style];
  }

  private dress(): void {
    const rules = themeRules(this.data, `#${this.root.id}`);
    if (rules !== this.rules) this.style.replaceSync(rules);
    this.rules = rules;
  }

  private sheets(): Document | ShadowRoot {
    const root = this.root.getRootNode();
    return root instanceof ShadowRoot ? root : document;
  }

  private hold(index: number): void {
    this.player.playing = false;
    this.player.go(index);
  }

  private draw(): void {
    this.transport.playing(this.player.playing);
    const row = this.view.order[this.player.at]!;
    if (row !== this.drawn) {
      this.drawn = row;
      const before = this.past && { view: this.past, row: sameInput(this.past, this.view.input.values[row]!, row) };
      this.drawing.draw(row, this.view.turned(this.player.at, this.player.back), before);
      this.ghost.draw(before);
      this.arrows.draw(row);
      if (this.view.series.length) this.charts.draw(row, this.turn);
      this.transport.draw(this.view, this.player.at, row);
      if (this.numbered) this.table.draw(row);
      if (this.numbered) this.polygon.draw(row);
      this.root.dataset.row = String(row);
      this.hooks.row?.(this.motion, row);
    }
    if (!this.player.playing) this.speakSoon();
    else if (this.words.element.open) this.reword.soon();
  }

  private tick(now: number): void {
    // During a drag every update draws a frame; no other frames are drawn.
    if (this.steady > -Infinity && now - this.steady > RESTS_AFTER * this.pace) this.settle();
    if (now - this.steady > UPDATED_WITHIN) this.pass(now);
    this.frame = requestAnimationFrame((next) => this.tick(next));
  }

  /** Advance the time: show the current row, or only move to it. */
  private pass(now: number, shown = true): void {
    const passed = Math.min(0.1, Math.max(0, now - this.last) / 1000);
    this.last = now;
    this.player.advance(passed, shown);
  }

  private heading(): HTMLElement {
    const head = html("header", { class: "lw-head" }, this.root);
    this.title = html("h1", {}, head, this.data.title);
    if (this.data.motions.length > 1) {
      const label = html("label", { class: "lw-choice" }, head, "Circuit ");
      this.choice = html("select", {}, label);
      this.data.motions.forEach((motion, k) => html("option", { value: k }, this.choice!, motion.name));
      this.choice.addEventListener("change", () => this.choose(this.choice!.selectedIndex));
    }
    this.summary = html("p", { class: "lw-summary" }, head);
    const corner = html("div", { class: "lw-corner" }, head);
    themeButton(corner, this.root);
    this.presentation = new Presentation(this.root, corner, this.gone.signal);
    declareKeys("Motion", this.commands);
    if (this.hooks.embedded) {
      this.presentation.button.remove(); // a cell of a notebook is not the page
      return head;
    }
    const keys = html("button", { type: "button", class: "lw-keys-button", "aria-label": "Keys", title: "All keys (?)" }, corner, "?");
    keys.addEventListener("click", () => showKeys(this.root));
    return head;
  }

  private toggles(parent: Element): HTMLElement {
    const box = html("div", { class: "lw-toggles", role: "group", "aria-label": "Display options" }, parent);
    toggle(box, "Paths", true, (on) => this.drawing.toggle("paths", on));
    toggle(box, "Names", true, (on) => this.drawing.toggle("names", on));
    this.arrows.switches(box);
    if (this.hooks.changing || this.data.motions.length > 1) {
      const compare = toggle(box, "Compare", false, (on) => this.compare(on));
      compare.title = "Keep the design shown now in pale lines, to compare it with others";
    }
    html("p", { class: "lw-hint" }, box, "Drag a pin or a link. Space plays, arrow keys step.");
    return box;
  }

  /** Keep the present design in pale lines, or forget it. */
  private compare(on: boolean): void {
    this.pinned = on;
    this.past = on ? this.view : null;
    this.show(this.motion, this.player.at);
  }

  /** A tall mechanism has its charts beside the drawing, a wide one below. */
  private layOut(): void {
    const [left, bottom, right, top] = this.data.view as [number, number, number, number];
    const tall = this.root.classList.contains("lw-tall");
    this.root.classList.toggle("lw-tall", (top - bottom) / (right - left) > (tall ? 0.7 : 0.85));
  }

  /** The default plots: outputs, unknowns, then derived quantities; lengths before angles. */
  private plotted(): string[] {
    const columns = this.data.motions[0]!.columns.slice(1);
    const groups = ["output", "unknown", "derived"];
    const rank = (k: number): number =>
      2 * groups.indexOf(columns[k]!.group) + (columns[k]!.unit === "deg" ? 1 : 0);
    const ordered = columns.map((_, k) => k).sort((a, b) => rank(a) - rank(b) || a - b);
    return ordered.slice(0, 2).map((k) => columns[k]!.name);
  }

  private equations(): void {
    if (!this.data.equations.length) return;
    this.equationBox.replaceChildren();
    const box = html("details", { class: "lw-equations", open: "" }, this.equationBox);
    html("summary", {}, box, "Loop equations");
    for (const equation of this.data.equations) {
      const line = html("div", { class: "lw-equation", tabindex: 0, role: "group", "aria-label": equation.label || "equation" }, box);
      html("span", {}, line, equation.label);
      const math = new DOMParser().parseFromString(equation.mathml, "text/html").body.firstElementChild;
      if (math) line.append(document.importNode(math, true));
    }
  }

  private listen(): void {
    const options = { signal: this.gone.signal };
    const keys: EventTarget = this.hooks.embedded ? this.root : document;
    keys.addEventListener("keydown", (event) => this.key(event as KeyboardEvent), options);
    this.drag(this.drawing.element);
    this.sized.observe(this.drawing.element);
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (target !== document.body && !this.root.contains(target)) return;
    const tag = target.tagName;
    const typed = ["SELECT", "TEXTAREA"].includes(tag) || (tag === "INPUT" && !target.closest(".lw-transport"));
    if (typed && event.key !== "Escape") return;
    if (event.key === " " && (tag === "BUTTON" || tag === "SUMMARY")) return;
    if (target.closest("dialog")) return;
    if (this.presentation.on && press(this.presentation.commands, event)) return;
    press([...this.commands, ...(this.hooks.embedded ? [] : this.presentation.commands)], event);
  }

  private readonly commands: readonly Command[] = [
    { keys: [" "], does: "Play, or stand still", act: () => this.player.play(!this.player.playing) },
    { keys: ["ArrowRight", "ArrowUp"], does: "The next position; with Shift the tenth", act: (event) => this.player.step(event.shiftKey ? 10 : 1) },
    { keys: ["ArrowLeft", "ArrowDown"], does: "The position before; with Shift ten before", act: (event) => this.player.step(event.shiftKey ? -10 : -1) },
    { keys: ["Home"], does: "The first position", act: () => this.hold(0) },
    { keys: ["End"], does: "The last position", act: () => this.hold(this.view.order.length - 1) },
    { keys: ["PageDown", "PageUp"], does: "The next circuit, or the one before", act: (event) => this.neighbour(event.key === "PageDown" ? 1 : -1) },
    { keys: ["."], does: "Say the position (screen readers)", act: () => this.sayAgain() },
    { keys: ["?"], does: "All keys", when: () => !this.hooks.embedded, act: () => showKeys(this.root) },
  ];

  private neighbour(by: number): void {
    const count = this.data.motions.length;
    if (count > 1) this.choose((this.motion + by + count) % count);
  }

  /** Drag a pin or a link: the nearest row on its path is shown. */
  private drag(canvas: SVGSVGElement): void {
    let way: Float64Array | null = null;
    let off: readonly [number, number] = [0, 0];
    let step: Step = { at: 0, sense: 0 };
    canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      const place = this.drawing.placeAt(event);
      const found = this.held(event.target as Element, place);
      if (found === null) return;
      event.preventDefault();
      this.player.play(false);
      step = { at: this.player.at, sense: 0 };
      way = found;
      off = [way[2 * step.at]! - place[0], way[2 * step.at + 1]! - place[1]];
      canvas.setPointerCapture(event.pointerId);
      canvas.classList.add("lw-dragging");
    });
    canvas.addEventListener("pointermove", (event) => {
      if (way === null) return;
      const [x, y] = this.drawing.placeAt(event);
      step = stepTowards(way, this.view.data.closed, step, x + off[0], y + off[1]);
      this.player.go(step.at);
    });
    for (const end of ["pointerup", "pointercancel"] as const) {
      canvas.addEventListener(end, () => {
        way = null;
        canvas.classList.remove("lw-dragging");
      });
    }
  }

  /** The path of the dragged point, or of a point on a link. */
  private held(target: Element, [x, y]: readonly [number, number]): Float64Array | null {
    const view = this.view;
    const point = target.getAttribute("data-point");
    if (point !== null) {
      const { x: xs, y: ys } = view.points[Number(point)]!;
      return Float64Array.from(view.order.flatMap((row) => [xs[row]!, ys[row]!]));
    }
    const frame = Number(target.closest("[data-frame]")?.getAttribute("data-frame") ?? -1);
    if (frame < 0) return null;
    const pose = view.pose(frame, view.order[this.player.at]!);
    const [cos, sin] = [Math.cos(pose.angle), Math.sin(pose.angle)];
    const [dx, dy] = [x - pose.x, y - pose.y];
    return view.wayOf(frame, [cos * dx + sin * dy, -sin * dx + cos * dy]);
  }

  /** Report the position to a screen reader when the motion stops. */
  private speakSoon(): void {
    clearTimeout(this.spoken);
    this.spoken = window.setTimeout(() => !this.player.playing && this.speak(), 600);
  }

  private describe(): void {
    this.words.show(this.data.title, this.view, this.view.order[this.player.at]!, this.player.playing, (what) => this.questions.hides(what));
  }

  /** Report the position even if it has been reported. */
  private sayAgain(): void {
    this.live.textContent = "";
    setTimeout(() => this.speak(), 50);
  }

  private speak(): void {
    this.describe();
    const view = this.view;
    const row = view.order[this.player.at]!;
    const secret = this.questions.hides("input") ? 0 : this.questions.hides("numbers") ? 1 : 4;
    const told = view.series.slice(0, secret).map((one) => `${one.shown} ${measured(one.values[row]!, one.unit)}`);
    const limit = this.questions.hides("limits") ? undefined : view.data.limits.find((one) => one.row === row)?.text;
    this.live.textContent = [view.data.name, ...told, ...(limit ? [limit] : [])].join(", ");
    this.drawing.element.setAttribute("aria-label", [this.data.title || "mechanism", ...told.slice(0, 1)].join(": "));
  }
}
