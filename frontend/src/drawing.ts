// The mechanism in SVG, with one group per frame; a new row only moves the groups.

import type { Before } from "./ghost";
import type { Course, MotionView } from "./motion";
import type { PageData, Part } from "./page_data";
import { QuickDrawing, type Drawn } from "./quick_drawing";
import { isArrow, reversal } from "./reversal";
import { pathOf, put, strokesOf, svg } from "./svg";
import { toneClass } from "./theme";
import { boxOf, symbolWidth, viewOf, zoomed, type View } from "./view_box";

/** The frame of a deforming shape. */
const OWN_COURSE = -2;

/** Margin of the view on each side, for parts outside the mechanism. */
const MOST_GROWTH = 1;

/** Size of names on the screen [px]. */
const SMALLEST = 12.5;

type Moved = (row: number) => void;

/** Updates existing elements with the data of a similar part. */
type Renewed = (part: Part) => void;

const LABELS = new Set(["label", "link_name", "limit_name"]);

export class Drawing {
  readonly element: SVGSVGElement;
  /** The top layer: arrows computed from a row. */
  readonly overlay: SVGGElement;
  /** The view: left, bottom, right, top. */
  view: readonly number[] = [];
  private readonly shapes: SVGGElement;
  private readonly handles: SVGGElement;
  private moved: Moved[] = [];
  private renewed: Renewed[] = [];
  private made = "";
  private drawn: Drawn[] = [];
  private readonly quick = new QuickDrawing();
  /** Whether the canvas shows the mechanism. */
  private hurried = false;
  /** Draws the canvas once more, in another view. */
  private again: () => void = () => {};
  /** Arrows of inputs, reversed while the input decreases. */
  private turned: Moved[] = [];
  private backwards = false;
  /** Points to include in the view, by purpose. */
  private readonly more = new Map<string, readonly (readonly [number, number])[]>();
  private motion!: MotionView;
  /** The view chosen by zooming or panning; null: that of the data. */
  private chosen: View | null = null;
  /** Height on the screen, and the window's width [px]. */
  private height = 0;
  private around = 0;
  /** Called after the view has changed. */
  viewed: () => void = () => {};

  constructor(
    private data: PageData,
    parent: Element,
  ) {
    this.element = svg(
      "svg",
      { class: "lw-drawing", role: "img", preserveAspectRatio: "xMidYMid meet" },
      parent,
    );
    this.renew(data);
    this.shapes = svg("g", { class: "lw-shapes" }, this.element);
    this.overlay = svg("g", { class: "lw-overlay" }, this.element);
    this.handles = svg("g", { class: "lw-handles" }, this.element);
  }

  /** Set other data: sizes of symbols and view. */
  renew(data: PageData): void {
    this.data = data;
    const whole = around(data.view, [...this.more.values()].flat());
    const [left, bottom, right, top] = (this.view = this.chosen ? this.chosenBox(this.chosen) : whole);
    const box = `${left} ${-top} ${right - left} ${top - bottom}`;
    if (box === this.element.getAttribute("viewBox")) return;
    this.element.setAttribute("viewBox", box);
    this.fit();
    this.viewed();
  }

  private chosenBox(chosen: View): [number, number, number, number] {
    const { width, height } = this.size;
    return boxOf(chosen, width, height);
  }

  /** The size of the drawing on the screen [px]. */
  private get size(): { width: number; height: number } {
    const { clientWidth, clientHeight } = this.element;
    return { width: clientWidth || 1, height: clientHeight || 1 };
  }

  /** The visible part of the plane. */
  get window(): View {
    const { width, height } = this.size;
    return this.chosen ?? viewOf(this.view, width, height);
  }

  /** The width by which symbols are sized. */
  get symbolWidth(): number {
    const { width, height } = this.size;
    return symbolWidth(this.window, width, height);
  }

  /** Keep a part of the plane visible; null: the whole drawing. */
  see(view: View | null): void {
    this.chosen = view;
    this.renew(this.data);
  }

  /** Zoom by a factor about a place in the plane. */
  zoom(factor: number, at: readonly [number, number]): void {
    this.see(zoomed(this.window, factor, at));
  }

  /** Move the visible part of the plane. */
  pan(dx: number, dy: number): void {
    const { x, y, width } = this.window;
    this.see({ x: x + dx, y: y + dy, width });
  }

  /** Length in the plane of one pixel. */
  get pixel(): number {
    return this.window.width / this.size.width;
  }

  /** Include these points in the view, unless the mechanism becomes too small; none: reset. */
  include(what: string, places: readonly (readonly [number, number])[]): void {
    const [left, bottom, right, top] = this.data.view as [number, number, number, number];
    const most = MOST_GROWTH * Math.max(right - left, top - bottom);
    const near = places.filter(([x, y]) => x > left - most && x < right + most && y > bottom - most && y < top + most);
    const air = places.length ? 0.08 * Math.max(right - left, top - bottom) : 0;
    this.more.set(what, near.flatMap(([x, y]) => [[x - air, y - air] as const, [x + air, y + air] as const]));
    this.renew(this.data);
  }

  /** The drawing has another size: if only its height changed, everything in a chosen view stays at its place. */
  resized(): void {
    const { width, height } = this.size;
    const lower = this.around === innerWidth ? this.height - height : 0;
    [this.height, this.around] = [height, innerWidth];
    if (this.chosen) this.pan(0, (lower / 2) * (this.chosen.width / width));
    this.fit();
  }

  /** Enlarge names in small drawings for legibility. */
  fit(): void {
    const matrix = this.element.getScreenCTM();
    if (matrix === null) return;
    const grow = SMALLEST / (this.data.text * matrix.a);
    this.element.style.setProperty("--grow", String(Math.min(1.6, Math.max(1, grow))));
    if (!this.hurried) return;
    if (!this.quick.fits(this.element)) this.quick.begin(this.element, this.drawn);
    this.again();
  }

  /** Draw another motion; equal shapes are kept and updated. `quick`: on a canvas, if it and the
   * design before (`past`) have the same shapes as the last one. */
  show(view: MotionView, quick = false, past: MotionView | null = null): void {
    this.motion = view;
    const wanted = madeOf(view);
    this.hurry(quick && wanted === this.made && (past === null || madeOf(past) === wanted));
    if (this.hurried) return;
    if (wanted === this.made) {
      view.data.parts.forEach((part, k) => this.renewed[k]!(part));
      return;
    }
    this.made = wanted;
    this.shapes.replaceChildren();
    this.handles.replaceChildren();
    this.moved = [];
    this.renewed = [];
    this.turned = [];
    this.drawn = [];
    let group: SVGGElement | null = null;
    let carried = Number.NaN;
    for (const part of view.data.parts) {
      if (part.kind === "text") {
        this.text(part);
        carried = Number.NaN;
      } else if (part.frame === OWN_COURSE) {
        this.changing(part);
        carried = Number.NaN;
      } else {
        if (part.frame !== carried || group === null) {
          group = this.group(part.frame);
          carried = part.frame;
        }
        this.shape(part, group);
      }
    }
    this.addHandles();
  }

  /** Change between the elements and the canvas. */
  private hurry(on: boolean): void {
    if (on === this.hurried) return;
    this.hurried = on;
    this.again = () => {};
    if (on) this.quick.begin(this.element, this.drawn);
    this.element.classList.toggle("lw-hurried", on);
    if (on) this.element.before(this.quick.element);
    else this.quick.element.remove();
  }

  /** Move all groups to a found row. */
  draw(row: number, backwards = false, before: Before | null = null): void {
    if (this.hurried) {
      this.backwards = backwards;
      this.again = () => this.quick.draw(this.motion, row, this.view, backwards, before);
      this.again();
      return;
    }
    for (const move of this.moved) move(row);
    if (backwards === this.backwards) return;
    this.backwards = backwards;
    for (const turn of this.turned) turn(row);
  }

  /** Show or hide paths or names. */
  toggle(what: "paths" | "names", on: boolean): void {
    this.element.classList.toggle(`without-${what}`, !on);
  }

  /** Fade moving parts behind the vectors. */
  dim(on: boolean): void {
    this.element.classList.toggle("lw-dimmed", on);
  }

  /** The coordinates in the plane of a point of the screen. */
  placeAt(event: { clientX: number; clientY: number }): [number, number] {
    const matrix = this.element.getScreenCTM();
    if (matrix === null) return [0, 0];
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    return [place.x, -place.y];
  }

  private group(frame: number): SVGGElement {
    const group = svg("g", { "data-frame": frame }, this.shapes);
    if (frame >= 0) {
      group.classList.add("lw-moving");
      this.moved.push((row) => {
        const { x, y, angle } = this.motion.pose(frame, row);
        group.setAttribute("transform", `translate(${x} ${-y}) rotate(${(-angle * 180) / Math.PI})`);
      });
    }
    return group;
  }

  private shape(part: Part, group: SVGGElement): void {
    const look = this.look(part);
    if (part.kind === "disc") {
      const circle = svg("circle", look, group);
      this.drawn.push([circle, null]);
      this.measured(part, ({ points: [x, y], radius }) => put(circle, { cx: x!, cy: -y!, r: radius }));
      return;
    }
    const driving = isArrow(part);
    const within = driving ? svg("g", {}, group) : group;
    const path = svg("path", look, within);
    const head = part.head.length ? svg("path", { ...look, class: `${look.class} filled lw-head` }, within) : null;
    this.drawn.push([path, head]);
    let round = "";
    const turn = (): void => put(within, { transform: this.backwards ? round : "" });
    this.measured(part, ({ kind, points, head: corners }) => {
      put(path, { d: kind === "strokes" ? strokesOf(points) : pathOf(points, kind === "area") });
      if (head) put(head, { d: pathOf(corners, true) });
      if (!driving) return;
      round = `matrix(${reversal(points, corners, -1).join(" ")})`;
      turn();
    });
    if (driving) this.turned.push(turn);
  }

  /** Updates a part, now and at every change. */
  private measured(part: Part, renewed: Renewed): void {
    renewed(part);
    this.renewed.push(renewed);
  }

  private changing(part: Part): void {
    let course: Course;
    const path = svg("path", this.look(part), this.shapes);
    path.classList.add("lw-changing");
    this.drawn.push([path, null]);
    const closed = part.kind === "area";
    this.measured(part, (own) => (course = this.motion.course(own)));
    this.moved.push((row) => {
      const there = course.shown[row] === 1;
      const corners = course.corners.map((corner) => corner[row]!);
      path.setAttribute(
        "d",
        !there ? "" : part.kind === "strokes" ? strokesOf(corners) : pathOf(corners, closed),
      );
    });
  }

  private text(part: Part): void {
    const anchor = (["start", "middle", "end"] as const)[part.align + 1]!;
    const element = svg("text", { ...this.look(part), "text-anchor": anchor }, this.shapes);
    element.textContent = part.text;
    this.drawn.push([element, null]);
    let [u, v] = [0, 0];
    const place = (row: number): void => {
      const { x, y, angle } = this.motion.pose(part.frame, row);
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      put(element, { transform: `translate(${x + cos * u - sin * v} ${-(y + sin * u + cos * v)})` });
    };
    this.measured(part, ({ points, offset: [dx, dy], height }) => {
      [u, v] = points as [number, number];
      put(element, { x: dx!, y: -dy! });
      const size = `calc(${height}px * var(--grow, 1) * var(--large, 1))`;
      if (element.style.fontSize !== size) element.style.fontSize = size;
      if (part.frame < 0) place(0);
    });
    if (part.frame >= 0) this.moved.push(place);
  }

  private look(part: Part): { class: string; "data-role": string; "data-of": string } {
    const names = [`r-${part.role}`, toneClass(part.tone, this.data)];
    if (part.kind === "area" || part.kind === "disc" || part.kind === "text") names.push("filled");
    if (LABELS.has(part.role)) names.push("lw-name");
    return { class: names.join(" "), "data-role": part.role, "data-of": part.of };
  }

  /** Round handles, larger than pins, in the top layer. */
  private addHandles(): void {
    const drawn = new Set(
      this.motion.data.parts.filter((part) => part.kind === "disc").map((part) => part.of),
    );
    this.motion.points.forEach((point, k) => {
      if (!point.moving || !drawn.has(point.name)) return;
      const handle = svg("circle", { class: "lw-handle", "data-point": k }, this.handles);
      this.moved.push((row) => {
        const { x, y } = this.motion.points[k]!;
        put(handle, { cx: x[row]!, cy: -y[row]!, r: 3.2 * this.data.pin });
      });
    });
  }
}

/** A view enlarged to more points. */
function around(view: readonly number[], places: readonly (readonly [number, number])[]): [number, number, number, number] {
  const [left, bottom, right, top] = view as [number, number, number, number];
  const xs = places.map(([x]) => x);
  const ys = places.map(([, y]) => y);
  return [Math.min(left, ...xs), Math.min(bottom, ...ys), Math.max(right, ...xs), Math.max(top, ...ys)];
}

/** A key of the elements of a motion: motions with equal keys can share elements. */
function madeOf(view: MotionView): string {
  const parts = view.data.parts.map(({ kind, role, of, tone, frame, text, align, head }) =>
    [kind, role, of, tone, frame, text, align, head.length > 0].join(" "),
  );
  return [...parts, ...view.points.map(({ name, moving }) => `${name} ${moving}`)].join("\n");
}
