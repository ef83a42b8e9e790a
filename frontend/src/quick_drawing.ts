// The picture while a dimension is dragged: the shapes of the drawing on a canvas, which needs no
// style, layout and painting of elements. Their looks are those of the elements, read once.

import { isGhost, type Before } from "./ghost";
import type { Course, MotionView } from "./motion";
import type { Part } from "./page_data";
import { isArrow, reversal } from "./reversal";

/** The colours and widths of an element, in the unit of the drawing. */
interface Look {
  readonly line: string;
  readonly width: number;
  readonly dashes: number[];
  readonly fill: string;
  readonly fillOpacity: number;
  readonly opacity: number;
  readonly font: string;
  readonly size: number;
}

/** A part with the looks of its elements; null: not displayed. */
interface Shape {
  readonly look: Look | null;
  readonly head: Look | null;
}

/** The elements that draw a part: its own, and its arrow head. */
export type Drawn = readonly [SVGElement, SVGElement | null];

/** From the plane (y up) to the canvas [device pixels]. */
interface Window {
  readonly scale: number;
  readonly x: number;
  readonly y: number;
}


const TURN = 2 * Math.PI;

/** The opacity of the design before, as that of its elements. */
const PALE = 0.22;

export class QuickDrawing {
  readonly element = document.createElement("canvas");
  private readonly own = this.element.getContext("2d")!;
  private readonly pale = document.createElement("canvas").getContext("2d")!;
  /** What the pale picture shows. */
  private kept: readonly unknown[] = [];
  private pen = this.own;
  /** The font of the pen as it was set: canvases write it otherwise. */
  private font = "";
  private shapes: readonly Shape[] = [];
  private view!: MotionView;
  private courses: readonly (Course | null)[] = [];
  private sheet: readonly [number, number] = [1, 1];
  private ratio = 1;

  constructor() {
    this.element.className = "lw-quick";
    this.element.setAttribute("aria-hidden", "true");
  }

  /** Take the place and the looks of a drawing that is displayed. */
  begin(over: SVGSVGElement, drawn: readonly Drawn[]): void {
    const { clientWidth: width, clientHeight: height } = over;
    const { left, top } = over.getBoundingClientRect();
    const home = over.parentElement!;
    const box = home.getBoundingClientRect();
    this.sheet = [width, height];
    this.ratio = devicePixelRatio || 1;
    this.element.width = Math.round(width * this.ratio);
    this.element.height = Math.round(height * this.ratio);
    const { style } = this.element;
    style.left = `${left - box.left - home.clientLeft}px`;
    style.top = `${top - box.top - home.clientTop}px`;
    style.width = `${width}px`;
    style.height = `${height}px`;
    this.shapes = drawn.map(([own, head]) => ({ look: lookOf(own), head: head && lookOf(head) }));
    this.kept = [];
    this.font = "";
  }

  /** Whether the drawing still has the size on the screen that was taken. */
  fits({ clientWidth, clientHeight }: Element): boolean {
    return clientWidth === this.sheet[0] && clientHeight === this.sheet[1];
  }

  /** Draw a row in a view (left, bottom, right, top) of the plane; `back`: arrows of inputs are reversed. */
  draw(view: MotionView, row: number, box: readonly number[], back: boolean, before: Before | null): void {
    const at = this.window(box);
    clear(this.own);
    if (before !== null) {
      this.keep(before, at);
      this.own.globalAlpha = PALE;
      this.own.drawImage(this.pale.canvas, 0, 0);
    }
    this.pen = this.own;
    this.motion(view);
    view.data.parts.forEach((part, k) => this.part(part, k, row, at, back));
  }

  /** The picture of the design before, as long as it is the same. */
  private keep({ view, row }: Before, at: Window): void {
    const wanted = [view, row, at.scale, at.x, at.y];
    if (wanted.every((one, k) => one === this.kept[k])) return;
    this.kept = wanted;
    this.pen = this.pale;
    [this.pale.canvas.width, this.pale.canvas.height] = [this.element.width, this.element.height];
    this.motion(view);
    view.data.parts.forEach((part, k) => isGhost(part) && this.part(part, k, row, at, false));
  }

  private motion(view: MotionView): void {
    if (view === this.view) return;
    this.view = view;
    this.courses = view.data.parts.map((part) => (part.course.length ? view.course(part) : null));
  }

  private part(part: Part, k: number, row: number, at: Window, back: boolean): void {
    const { look, head } = this.shapes[k]!;
    if (look === null) return;
    this.pen.globalAlpha = look.opacity;
    if (part.kind === "text") this.text(part, look, row, at);
    else this.shape(part, [look, head], this.courses[k]!, row, at, back);
  }

  /** The whole view, in the middle of the sheet. */
  private window([left, bottom, right, top]: readonly number[]): Window {
    const [width, height] = this.sheet;
    const scale = this.ratio * Math.min(width / (right! - left!), height / (top! - bottom!));
    const x = (this.ratio * width - scale * (left! + right!)) / 2;
    const y = (this.ratio * height + scale * (bottom! + top!)) / 2;
    return { scale, x, y };
  }

  private shape(part: Part, [look, head]: readonly [Look, Look | null], course: Course | null, row: number, at: Window, back: boolean): void {
    const { pen } = this;
    const { x, y, angle } = this.view.pose(part.frame, row);
    const [cos, sin] = [at.scale * Math.cos(angle), at.scale * Math.sin(angle)];
    pen.setTransform(cos, -sin, -sin, -cos, at.scale * x + at.x, at.y - at.scale * y);
    if (back && isArrow(part)) pen.transform(...reversal(part.points, part.head, 1));
    pen.beginPath();
    if (course !== null) {
      if (course.shown[row] !== 1) return;
      trace(pen, course.corners.map((corner) => corner[row]!), part.kind);
    } else if (part.kind === "disc") pen.arc(part.points[0]!, part.points[1]!, part.radius, 0, TURN);
    else trace(pen, part.points, part.kind);
    paint(pen, look);
    if (head === null) return;
    pen.beginPath();
    trace(pen, part.head, "area");
    paint(pen, head);
  }

  /** A name, in pixels: fonts of other units may be too small. */
  private text(part: Part, look: Look, row: number, at: Window): void {
    const { pen } = this;
    const { x, y, angle } = this.view.pose(part.frame, row);
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const [u, v] = part.points as [number, number];
    const [dx, dy] = part.offset as [number, number];
    const size = look.size * at.scale;
    pen.setTransform(1, 0, 0, 1, at.scale * (x + cos * u - sin * v + dx) + at.x, at.y - at.scale * (y + sin * u + cos * v + dy));
    const font = look.font.replace("1px", `${size.toFixed(2)}px`);
    if (font !== this.font) pen.font = this.font = font;
    pen.textAlign = (["left", "center", "right"] as const)[part.align + 1]!;
    pen.lineJoin = "round";
    pen.setLineDash([]);
    if (look.line) {
      pen.strokeStyle = look.line;
      pen.lineWidth = look.width * at.scale;
      pen.strokeText(part.text, 0, 0);
    }
    pen.fillStyle = look.fill;
    pen.fillText(part.text, 0, 0);
  }
}

function clear(pen: CanvasRenderingContext2D): void {
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.clearRect(0, 0, pen.canvas.width, pen.canvas.height);
}

/** Corners x, y, x, y, … as a path. */
function trace(pen: CanvasRenderingContext2D, points: ArrayLike<number>, kind: string): void {
  const piece = kind === "strokes" ? 4 : points.length;
  for (let k = 0; k + 1 < points.length; k += 2) {
    if (k % piece === 0) pen.moveTo(points[k]!, points[k + 1]!);
    else pen.lineTo(points[k]!, points[k + 1]!);
  }
  if (kind === "area") pen.closePath();
}

function paint(pen: CanvasRenderingContext2D, look: Look): void {
  const whole = pen.globalAlpha;
  if (look.fill) {
    pen.globalAlpha = whole * look.fillOpacity;
    pen.fillStyle = look.fill;
    pen.fill();
    pen.globalAlpha = whole;
  }
  if (!look.line || !look.width) return;
  pen.strokeStyle = look.line;
  pen.lineWidth = look.width;
  pen.lineCap = "round";
  pen.lineJoin = "round";
  pen.setLineDash(look.dashes);
  pen.stroke();
}

function lookOf(element: SVGElement): Look | null {
  const style = getComputedStyle(element);
  if (style.display === "none") return null;
  const within = getComputedStyle(element.parentElement!);
  return {
    line: style.stroke === "none" ? "" : style.stroke,
    width: parseFloat(style.strokeWidth) || 0,
    dashes: style.strokeDasharray === "none" ? [] : style.strokeDasharray.split(/[\s,]+/).map(parseFloat),
    fill: style.fill === "none" ? "" : style.fill,
    fillOpacity: Number(style.fillOpacity),
    opacity: Number(style.opacity) * Number(within.opacity),
    font: `${style.fontWeight} 1px ${style.fontFamily}`,
    size: parseFloat(style.fontSize),
  };
}
