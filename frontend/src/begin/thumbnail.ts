// A small moving picture of a mechanism, drawn from coordinates that were computed before.

import { put, svg } from "../svg";
import type { Outline, Picture } from "./library";

const AIR = 16;
const TONES = 6;

export class Thumbnail {
  readonly element: SVGSVGElement;
  private readonly moves: ((frame: readonly number[], number: number) => void)[] = [];
  private shown = -1;

  constructor(readonly picture: Picture) {
    const [width, height] = picture.box;
    const side = Math.max(width, height) + 2 * AIR;
    const [left, top] = [(width - side) / 2, (height - side) / 2];
    this.element = svg("svg", { viewBox: `${left} ${top} ${side} ${side}`, class: "lw-thumbnail", "aria-hidden": "true" });
    for (const trace of picture.traces) svg("path", { class: "trace", d: line(trace, false) }, this.element);
    for (const [centre, radius] of picture.discs) this.disc(centre, radius);
    for (const outline of picture.outlines) this.outline(outline);
    picture.bars.forEach((bar, k) => this.bar(bar, k));
    for (const block of picture.blocks) this.block(block);
    for (const point of picture.fixed) this.ground(point);
    for (const point of picture.pins) this.pin(point);
    this.show(0);
  }

  show(number: number): void {
    if (number === this.shown) return;
    this.shown = number;
    const frame = this.picture.frames[number]!;
    for (const move of this.moves) move(frame, number);
  }

  private bar(points: readonly number[], k: number): void {
    const path = svg("path", { class: `bar tone-${k % TONES}${points.length > 2 ? " plate" : ""}` }, this.element);
    this.moves.push((frame) => put(path, { d: line(points.flatMap((p) => [frame[2 * p]!, frame[2 * p + 1]!]), points.length > 2) }));
  }

  private block([point, a, b]: readonly [number, number, number]): void {
    const block = svg("rect", { class: "block", x: -11, y: -7, width: 22, height: 14 }, this.element);
    this.moves.push((frame) => {
      const angle = (Math.atan2(frame[2 * b + 1]! - frame[2 * a + 1]!, frame[2 * b]! - frame[2 * a]!) * 180) / Math.PI;
      put(block, { transform: `translate(${frame[2 * point]} ${frame[2 * point + 1]}) rotate(${angle})` });
    });
  }

  private outline({ center, points, closed, turns }: Outline): void {
    const path = svg("path", { class: closed ? "disc" : "rail", d: line(points, closed) }, this.element);
    this.moves.push((frame, number) => put(path, { transform: `translate(${frame[2 * center]} ${frame[2 * center + 1]}) rotate(${turns[number]})` }));
  }

  private disc(centre: number, radius: number): void {
    const disc = svg("circle", { class: "disc", r: radius }, this.element);
    this.moves.push((frame) => put(disc, { cx: frame[2 * centre]!, cy: frame[2 * centre + 1]! }));
  }

  private ground(point: number): void {
    const [x, y] = [this.picture.frames[0]![2 * point]!, this.picture.frames[0]![2 * point + 1]!];
    svg("path", { class: "ground", d: `M${x} ${y}l7 11h-14z` }, this.element);
  }

  private pin(point: number): void {
    const pin = svg("circle", { class: "pin", r: 3.6 }, this.element);
    this.moves.push((frame) => put(pin, { cx: frame[2 * point]!, cy: frame[2 * point + 1]! }));
  }
}

function line(points: readonly number[], closed: boolean): string {
  let text = "";
  for (let k = 0; k < points.length; k += 2) text += `${k ? "L" : "M"}${points[k]} ${points[k + 1]}`;
  return text + (closed ? "Z" : "");
}
