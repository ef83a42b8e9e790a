// The canvas of a task: its points and poses, the chosen design, and the tools that change them.

import type { DesignFound, LiveRequest, TaskSolved, TaskState } from "../messages";
import { html, pathOf, svg } from "../svg";
import { viewOf, zoomed, type View } from "../view_box";
import { boxAround, distance, pairs, resampled, roundedTo, type Box, type Place } from "./geometry";
import { ARM, Handles, placeOf, radians, sameThing, type Thing } from "./handles";
import { drawGhost, drawLinkage, drawSkeleton } from "./linkage_drawing";
import { ToolBar, type Tool } from "./tools";

export interface CanvasHooks {
  /** Send a change once. */
  readonly ask: (request: LiveRequest) => void;
  /** Send a change of a drag. */
  readonly drag: (request: LiveRequest) => void;
  /** A thing was picked. */
  readonly picked: (thing: Thing | null) => void;
}

/** Points that stand for a drawn curve. */
const SAMPLES = 40;
/** More positions have their pictures paler. */
const MANY = 5;
/** The share of the canvas around what is seen whole. */
const AIR = 0.16;
/** Room for the tools [px]. */
const MARGIN = 64;
/** Shown before there is anything [length]. */
const EMPTY: Box = [-100, -75, 100, 75];

export class TaskCanvas {
  readonly element = html("div", { class: "lw-canvas lw-t-canvas" });
  private readonly svg = svg("svg", { class: "lw-t-drawing", role: "group", "aria-label": "The task and the chosen design" }, this.element);
  private readonly back = svg("g", {}, this.svg);
  private readonly middle = svg("g", { "aria-hidden": "true" }, this.svg);
  private readonly front = svg("g", {}, this.svg);
  private readonly sketch = svg("g", { "aria-hidden": "true" }, this.svg);
  private readonly handles: Handles;
  private readonly tools: ToolBar;
  private view: View = viewOf(EMPTY, 1, 1);
  private seen = false;
  /** Whether the visitor has chosen the view. */
  private own = false;
  private task: TaskState | null = null;
  private solved: TaskSolved | null = null;
  private design: DesignFound | null = null;
  private row: readonly number[] | null = null;
  private at: number | null = null;
  picked: Thing | null = null;
  private tool: Tool = "move";
  private held: { thing: Thing; off: Place } | null = null;
  private drawn: Place[] | null = null;
  private panned = false;
  private readonly touches = new Map<number, Place>();
  /** The change of the drag in progress, which is sent again when it ends. */
  private last: LiveRequest | null = null;

  constructor(private readonly hooks: CanvasHooks) {
    this.handles = new Handles(this.front, (thing) => this.pick(thing));
    this.tools = new ToolBar((tool) => this.choose(tool));
    this.element.append(this.tools.element, this.zoomButtons());
    this.svg.addEventListener("pointerdown", (event) => this.press(event));
    this.svg.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"] as const) this.svg.addEventListener(end, (event) => this.release(event));
    this.svg.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    new ResizeObserver(() => (this.own ? this.draw() : this.whole())).observe(this.element);
  }

  /** The size of a pixel in the plane. */
  get pixel(): number {
    return this.view.width / Math.max(1, this.element.clientWidth);
  }

  get dragging(): boolean {
    return this.held !== null;
  }

  show(task: TaskState): void {
    const other = this.task === null || this.task.file !== task.file;
    this.task = task;
    if (this.picked && !placeOf(task, this.picked)) this.pick(null);
    this.tools.show(task);
    if (other) this.seen = false;
    if (this.seen) this.draw();
    else this.whole();
  }

  /** The designs, and the one that is looked at. */
  solve(solved: TaskSolved | null): void {
    this.solved = solved;
    if (solved === null) this.design = null;
    else if (solved.chosen !== null || !solved.live) this.look(solved.chosen);
    this.draw();
  }

  /** Look at a design; the view changes if it is out of sight. */
  look(design: DesignFound | null): void {
    this.design = design;
    this.row = design?.at[0] ?? design?.rows[0] ?? null;
    if (design && !this.dragging && !this.inSight(design)) this.whole();
    else this.draw();
  }

  /** The design at a row of its points; `at`: the position it passes there. */
  stand(row: readonly number[] | null, at: number | null): void {
    this.row = row;
    this.at = at;
    this.draw();
  }

  /** Pick a thing, as a table does. */
  pick(thing: Thing | null): void {
    if (sameThing(thing, this.picked)) return;
    this.picked = thing;
    this.hooks.picked(thing);
    this.draw();
  }

  choose(tool: Tool): void {
    this.tool = tool;
    this.tools.choose(tool);
    this.svg.classList.toggle("lw-t-placing", tool !== "move");
  }

  /** Move the picked thing by steps on the screen; with `fine` by the smallest ones. */
  nudge(dx: number, dy: number, fine: boolean): boolean {
    const { picked, task } = this;
    if (!picked || !task) return false;
    const step = this.step * (fine ? 1 : 10);
    if (picked.knob && picked.of === "position") {
      const angle = task.positions[picked.index]!.angle ?? 0;
      const by = (fine ? 0.1 : 1) * (task.angle_unit === "rad" ? Math.PI / 180 : 1);
      this.hooks.ask({ kind: "turn_pose", index: picked.index, angle: roundedTo(angle + (dx + dy) * by, 1e-6) });
      return true;
    }
    const [x, y] = placeOf(task, picked)!;
    if (picked.knob) this.hooks.ask({ kind: "move_task_point", of: picked.of, index: picked.index, x, y, radius: Math.max(step, task.obstacles[picked.index]![2] + (dx + dy) * step) });
    else this.hooks.ask({ kind: "move_task_point", of: picked.of, index: picked.index, x: roundedTo(x + dx * step, this.step), y: roundedTo(y + dy * step, this.step) });
    return true;
  }

  remove(): boolean {
    if (!this.picked) return false;
    this.hooks.ask({ kind: "remove_task_point", of: this.picked.of, index: this.picked.index });
    return true;
  }

  zoom(factor: number): void {
    this.own = true;
    this.view = zoomed(this.view, factor, [this.view.x, this.view.y]);
    this.draw();
  }

  /** See the task and the design whole. */
  whole(): void {
    this.own = false;
    if (this.element.clientHeight < 2 * MARGIN) return; // not in sight
    const box = boxAround(this.extent());
    if (box) {
      const least = Math.max(box[2] - box[0], box[3] - box[1]) || 100;
      const air = AIR * least;
      const padded: Box = [box[0] - air, box[1] - air, box[2] + air, box[3] + air];
      this.view = this.fitted(padded);
      this.seen = true;
    } else this.view = this.fitted(EMPTY);
    this.draw();
  }

  /** The view of a box beside the tools, or above them on a narrow screen. */
  private fitted(box: Box): View {
    const { clientWidth: w, clientHeight: h } = this.element;
    const narrow = w < 520;
    const [left, below, above] = narrow ? [0, MARGIN, 44] : [MARGIN, 0, 0];
    const view = viewOf(box, w - left, h - below - above);
    const pixel = view.width / Math.max(1, w - left);
    return { x: view.x - (pixel * left) / 2, y: view.y + (pixel * (above - below)) / 2, width: pixel * w };
  }

  private *extent(): Iterable<Place> {
    const { task, design } = this;
    for (const { x, y } of task?.positions ?? []) yield [x, y];
    yield* task?.fixed_pivots ?? [];
    yield* task?.region ?? [];
    for (const [x, y, r] of task?.obstacles ?? []) yield* [[x - r, y - r], [x + r, y + r]] as Place[];
    if (design) yield* placesOf(design);
  }

  private inSight(design: DesignFound): boolean {
    const box = boxAround(placesOf(design));
    if (!box) return true;
    const [w, h] = [this.element.clientWidth, this.element.clientHeight];
    const [[left, top], [right, bottom]] = [this.project([box[0], box[3]]), this.project([box[2], box[1]])];
    return left > -0.05 * w && right < 1.05 * w && top > -0.05 * h && bottom < 1.05 * h && (right - left > 0.25 * w || bottom - top > 0.25 * h);
  }

  private readonly project = ([x, y]: Place): Place => {
    const pixel = this.pixel;
    return [this.element.clientWidth / 2 + (x - this.view.x) / pixel, this.element.clientHeight / 2 - (y - this.view.y) / pixel];
  };

  private placeAt(event: { clientX: number; clientY: number }): Place {
    const box = this.element.getBoundingClientRect();
    const [px, py] = [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
    return [this.view.x + px * this.pixel, this.view.y - py * this.pixel];
  }

  /** The step of numbers: a nice one below a pixel. */
  private get step(): number {
    return 10 ** Math.floor(Math.log10(this.pixel) + 0.3);
  }

  private rounded([x, y]: Place): Place {
    return [roundedTo(x, this.step), roundedTo(y, this.step)];
  }

  private zoomButtons(): HTMLElement {
    const box = html("div", { class: "lw-zoom", role: "group", "aria-label": "View" });
    for (const [text, name, keys, act] of [
      ["+", "Zoom in", "+", () => this.zoom(1.25)],
      ["−", "Zoom out", "-", () => this.zoom(0.8)],
      ["⤢", "See the whole task", "0", () => this.whole()],
    ] as const) {
      const button = html("button", { type: "button", title: `${name} (${keys})`, "aria-label": name, "aria-keyshortcuts": keys }, box, text);
      button.addEventListener("click", act);
    }
    return box;
  }

  // Pointers

  private press(event: PointerEvent): void {
    if (event.button !== 0 || !this.task) return;
    this.touches.set(event.pointerId, [event.clientX, event.clientY]);
    this.svg.setPointerCapture(event.pointerId);
    event.preventDefault();
    if (this.touches.size === 2) {
      this.drop();
      return;
    }
    const target = (event.target as Element).closest<SVGGElement>(".lw-t-handle");
    const place = this.placeAt(event);
    if (target && this.tool === "move") {
      const thing: Thing = { of: target.dataset.of as Thing["of"], index: Number(target.dataset.index), knob: target.dataset.knob === "true" };
      if (thing.of === "position" && this.task.positions_from_file) return;
      this.pick(thing);
      target.focus({ preventScroll: true });
      const at = placeOf(this.task, thing)!;
      this.held = { thing, off: thing.knob ? [0, 0] : [at[0] - place[0], at[1] - place[1]] };
    } else if (this.tool === "move") {
      this.pick(null);
      this.panned = true;
    } else this.drawn = [place];
  }

  private move(event: PointerEvent): void {
    const before = this.touches.get(event.pointerId);
    if (!before) return;
    const now: Place = [event.clientX, event.clientY];
    this.touches.set(event.pointerId, now);
    if (this.touches.size === 2) this.pinch(event.pointerId, before, now);
    else if (this.held) this.pull(this.placeAt(event));
    else if (this.drawn) {
      this.drawn.push(this.placeAt(event));
      this.preview();
    } else if (this.panned) {
      this.view = { ...this.view, x: this.view.x - (now[0] - before[0]) * this.pixel, y: this.view.y + (now[1] - before[1]) * this.pixel };
      this.draw();
    }
  }

  private pinch(id: number, before: Place, now: Place): void {
    this.own = true;
    const other = [...this.touches].find(([one]) => one !== id)![1];
    const centre = this.placeAt({ clientX: (now[0] + other[0]) / 2, clientY: (now[1] + other[1]) / 2 });
    this.view = zoomed(this.view, distance(now, other) / Math.max(1, distance(before, other)), centre);
    this.draw();
  }

  /** Send the change of a drag, and show it at once. */
  private pull(place: Place): void {
    const { thing, off } = this.held!;
    const task = this.task!;
    const request = this.changeOf(thing, [place[0] + off[0], place[1] + off[1]]);
    this.last = request;
    this.task = moved(task, request);
    this.draw();
    this.hooks.drag({ ...request, live: true } as LiveRequest);
  }

  private changeOf(thing: Thing, to: Place): LiveRequest {
    const task = this.task!;
    const { of, index } = thing;
    const [cx, cy] = placeOf(task, thing)!;
    if (thing.knob && of === "position") {
      const angle = Math.atan2(to[1] - cy, to[0] - cx) / radians(task);
      const turn = task.angle_unit === "rad" ? 2 * Math.PI : 360;
      const before = task.positions[index]!.angle ?? 0;
      const near = angle + turn * Math.round((before - angle) / turn);
      const step = Math.atan2(1, Math.max(ARM, distance(to, [cx, cy]) / this.pixel)) / radians(task);
      return { kind: "turn_pose", index, angle: roundedTo(near, 10 ** Math.floor(Math.log10(step) + 0.3)) };
    }
    if (thing.knob) return { kind: "move_task_point", of, index, x: cx, y: cy, radius: Math.max(this.step, roundedTo(distance(to, [cx, cy]), this.step)) };
    const [x, y] = this.rounded(to);
    return { kind: "move_task_point", of, index, x, y };
  }

  private release(event: PointerEvent): void {
    if (!this.touches.delete(event.pointerId)) return;
    this.panned = false;
    if (this.held) this.drop();
    const drawn = this.drawn;
    this.drawn = null;
    this.sketch.replaceChildren();
    if (drawn && event.type === "pointerup") this.place(drawn);
  }

  /** End a drag: its last change counts. */
  private drop(): void {
    this.held = null;
    if (this.last) this.hooks.ask(this.last);
    this.last = null;
  }

  /** What a tool does with a drawn line, or with a click. */
  private place(drawn: readonly Place[]): void {
    const [first, last] = [this.rounded(drawn[0]!), this.rounded(drawn.at(-1)!)];
    const clicked = drawn.every((place) => distance(place, drawn[0]!) < 5 * this.pixel);
    const [x, y] = last;
    switch (this.tool) {
      case "position":
        this.hooks.ask({ kind: "add_task_point", of: "position", x, y });
        return;
      case "pivot":
        this.hooks.ask({ kind: "add_task_point", of: "fixed pivot", x, y });
        this.choose("move");
        return;
      case "curve":
        if (clicked) return;
        this.hooks.ask({ kind: "draw_curve", points: resampled(drawn, SAMPLES).flatMap((place) => [...this.rounded(place)]) });
        this.choose("move");
        return;
      case "region": {
        if (clicked) return;
        const [left, right, low, high] = [Math.min(first[0], x), Math.max(first[0], x), Math.min(first[1], y), Math.max(first[1], y)];
        this.hooks.ask({ kind: "set_region", corners: [left, low, right, low, right, high, left, high] });
        this.choose("move");
        return;
      }
      case "obstacle":
        this.hooks.ask({ kind: "add_task_point", of: "obstacle", x: first[0], y: first[1], radius: roundedTo(clicked ? 20 * this.pixel : distance(first, last), this.step) });
        this.choose("move");
    }
  }

  /** The line that a tool draws. */
  private preview(): void {
    const drawn = this.drawn!.map(this.project);
    const [first, last] = [drawn[0]!, drawn.at(-1)!];
    this.sketch.replaceChildren();
    if (this.tool === "curve") svg("path", { d: `M${drawn.map(([x, y]) => `${x} ${y}`).join("L")}`, class: "lw-t-stroke" }, this.sketch);
    if (this.tool === "obstacle") svg("circle", { cx: first[0], cy: first[1], r: distance(first, last), class: "lw-t-disc" }, this.sketch);
    if (this.tool === "region") svg("rect", { x: Math.min(first[0], last[0]), y: Math.min(first[1], last[1]), width: Math.abs(last[0] - first[0]), height: Math.abs(last[1] - first[1]), class: "lw-t-region" }, this.sketch);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.own = true;
    this.view = zoomed(this.view, Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 30 : 1)), this.placeAt(event));
    this.draw();
  }

  // Drawing

  private draw(): void {
    const { task } = this;
    const { clientWidth: w, clientHeight: h } = this.element;
    if (!task || !w) return;
    this.svg.setAttribute("viewBox", `0 0 ${w} ${h}`);
    this.background(task);
    this.mechanism();
    this.handles.draw(task, this.project, this.pixel, this.picked, this.at);
  }

  private background(task: TaskState): void {
    this.back.replaceChildren();
    if (task.region.length > 2) this.path(this.back, task.region.flat(), "lw-t-region", true);
    for (const piece of this.solved?.centre_curve ?? []) this.path(this.back, piece, "lw-t-centre");
    const dyads = this.solved?.dyads ?? [];
    if (dyads.length <= 12) for (const { fixed, kind } of dyads) if (kind === "RR") {
      const [x, y] = this.project(fixed);
      svg("circle", { cx: x, cy: y, r: 3.5, class: "lw-t-dyad" }, this.back);
    }
    if (task.task === "path" && task.positions.length > 12) this.path(this.back, task.positions.flatMap(({ x, y }) => [x, y]), "lw-t-wanted");
  }

  private path(group: Element, points: readonly number[], name: string, closed = false): void {
    const flat = pairs(points).flatMap((place) => {
      const [x, y] = this.project(place);
      return [x, -y];
    });
    svg("path", { d: pathOf(flat, closed), class: name }, group);
  }

  private mechanism(): void {
    this.middle.replaceChildren();
    const { design, row } = this;
    if (!design) return;
    this.middle.setAttribute("class", `${design.design.sound ? "" : "lw-t-refused"} ${design.at.length > MANY ? "lw-t-many" : ""}`);
    const guided = this.task!.task !== "function"; // no point of the coupler is wanted there
    if (guided) for (const piece of design.curve) this.path(this.middle, piece, "lw-t-curve");
    if (design.skeleton) {
      if (row) drawSkeleton(this.middle, design.skeleton, row, this.project, this.pixel);
      return;
    }
    if (guided && design.at.length <= 12) for (const one of design.at) drawGhost(this.middle, one, this.project);
    if (row) drawLinkage(this.middle, design, row, this.project, true);
  }
}

function* placesOf(design: DesignFound): Iterable<Place> {
  yield* design.fixed.flat();
  for (const row of design.rows.length ? design.rows : design.at) yield* pairs(row);
}

/** The task with a change that has not been answered yet. */
function moved(task: TaskState, request: LiveRequest): TaskState {
  const at = <T>(list: readonly T[], index: number, change: (one: T) => T): T[] => list.map((one, k) => (k === index ? change(one) : one));
  if (request.kind === "turn_pose") return { ...task, positions: at(task.positions, request.index, (one) => ({ ...one, angle: request.angle })) };
  if (request.kind !== "move_task_point") return task;
  const { index, x, y, radius } = request;
  switch (request.of) {
    case "position":
      return { ...task, positions: at(task.positions, index, (one) => ({ ...one, x, y })) };
    case "fixed pivot":
      return { ...task, fixed_pivots: at(task.fixed_pivots, index, () => [x, y] as const) };
    case "moving pivot":
      return { ...task, moving_pivots: at(task.moving_pivots, index, () => [x, y] as const) };
    case "corner":
      return { ...task, region: at(task.region, index, () => [x, y] as const) };
    default:
      return { ...task, obstacles: at(task.obstacles, index, ([, , r]) => [x, y, radius ?? r] as const) };
  }
}
