// All kinds of arrows over the drawing, their switches, and the legend of scales.

import { Arrows, Names, type ArrowKind } from "./arrows";
import { toggle } from "./controls";
import type { Drawing } from "./drawing";
import type { MotionView } from "./motion";
import type { PageData } from "./page_data";
import { html, say } from "./svg";

const CALLED: Readonly<Record<ArrowKind, string>> = {
  vectors: "Vectors",
  velocities: "Velocities",
  accelerations: "Accelerations",
  forces: "Forces",
};

export class ArrowSets {
  private readonly kinds: readonly Arrows[];
  private readonly legend: HTMLElement;
  private readonly labels = new Map<Arrows, HTMLElement>();
  private readonly names: Names;
  private row = -1;
  private room = "[]";

  constructor(
    data: PageData,
    private readonly drawing: Drawing,
    canvas: Element,
  ) {
    const kinds = Object.keys(CALLED) as ArrowKind[];
    this.names = new Names(data.view);
    this.kinds = kinds.map((kind) => new Arrows(data, drawing.overlay, kind, this.names));
    this.legend = html("p", { class: "lw-legend", hidden: "" }, canvas);
  }

  /** A switch for every kind with arrows; forces are on. */
  switches(box: Element): void {
    for (const arrows of this.kinds) {
      arrows.shown = arrows.kind === "forces";
      const made = toggle(box, CALLED[arrows.kind], arrows.shown, (on) => {
        arrows.shown = on;
        if (arrows.kind === "vectors") this.drawing.dim(on);
        this.draw(this.row);
      });
      this.labels.set(arrows, made.parentElement!);
    }
    this.offer();
  }

  /** Switches of arrows that there are: an edit may add loads. */
  private offer(): void {
    for (const [arrows, label] of this.labels) label.hidden = !arrows.any;
  }

  renew(data: PageData): void {
    this.names.view = this.drawing.view;
    for (const arrows of this.kinds) arrows.renew(data);
    this.offer();
  }

  show(view: MotionView): void {
    for (const arrows of this.kinds) arrows.show(view);
  }

  private drawAll(row: number): void {
    this.names.begin();
    for (const arrows of this.kinds) arrows.draw(row);
  }

  /** Enlarge the view to the extent of arrows, if it has changed. */
  private makeRoom(): boolean {
    const reach = this.kinds.flatMap((arrows) => (arrows.shown ? arrows.reach : []));
    const wanted = JSON.stringify(reach);
    if (wanted === this.room) return false;
    this.room = wanted;
    this.drawing.include("arrows", reach);
    this.names.view = this.drawing.view;
    return true;
  }

  draw(row: number): void {
    this.row = row;
    this.drawAll(row);
    if (this.makeRoom()) this.drawAll(row); // names stand where there was no room before
    const told = this.kinds.filter((arrows) => arrows.shown && arrows.legend).map((arrows) => arrows.legend);
    say(this.legend, told.join("\n"));
    this.legend.hidden = told.length === 0;
  }
}
