// A pointer that keys move: points and links take the focus, and every tool works from there.

import { declareKeys, press, type Command } from "../../keys";
import type { Mounted } from "../../mount";
import { put, svg } from "../../svg";
import type { Place, Sketch } from "./geometry";
import type { Chosen } from "./selected";

/** No pointer of a screen has this number. */
const ID = -7;
const ARROWS: Readonly<Record<string, Place>> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export interface KeyPointerHooks {
  /** Select a point or link. */
  readonly choose: (chosen: Chosen) => void;
  /** Show a short hint. */
  readonly hint: (text: string) => void;
  /** Whether the tool acts on a click now; otherwise a line is drawn. */
  readonly clicks: () => boolean;
}

interface Thing extends Chosen {
  readonly at: Place;
  readonly told: string;
}

export class KeyPointer {
  private readonly group = svg("g", { class: "lw-keyed" });
  private readonly handles = svg("g", {}, this.group);
  private readonly cross = svg("path", { class: "lw-keyed-cross", "aria-hidden": "true" }, this.group);
  private page: Mounted | null = null;
  private tool = "";
  private step = 0;
  private at: Place | null = null;
  private down = false;

  constructor(private readonly hooks: KeyPointerHooks) {
    declareKeys("Drawing by keyboard", [{ keys: ["Tab"], does: "The next point, then the links, of the drawing" }, ...this.commands]);
  }

  /** Whether the arrow keys are not used for a line. */
  get idle(): boolean {
    return !this.down;
  }

  attach(page: Mounted, signal: AbortSignal): void {
    this.page = page;
    const { element } = page.places.drawing;
    element.append(this.group);
    element.addEventListener("keydown", (event) => press(this.commands, event) && event.stopPropagation(), { signal });
    element.addEventListener("focusin", (event) => this.focused(event.target as Element), { signal });
    element.addEventListener("focusout", (event) => !element.contains(event.relatedTarget as Node | null) && this.hide(), { signal });
  }

  /** Let the points and links of a sketch take the focus; null: nothing is edited. */
  offer(page: Mounted, sketch: Sketch | null, tool: string, step: number): void {
    [this.tool, this.step] = [tool, step];
    const { drawing } = page.places;
    const { element } = drawing;
    put(element, sketch ? { tabindex: 0, role: "application", "aria-roledescription": "drawing" } : { tabindex: -1, role: "img" });
    if (!sketch) element.removeAttribute("aria-roledescription");
    const things = sketch ? thingsOf(sketch) : [];
    const names = things.map(({ kind, name }) => `${kind} ${name}`).join("\n");
    const again = this.handles.dataset.names !== names;
    const [focus, from] = [document.activeElement, this.at];
    if (again) this.make(things, names);
    const pixel = things.length ? drawing.pixel : 1; // measured only if needed
    things.forEach(({ at: [x, y], told }, k) => put(this.handles.children[k]!, { cx: x, cy: -y, r: 11 * pixel, "aria-label": told }));
    if (again && focus && from && (focus === element || focus.hasAttribute("data-named"))) this.refocus(things, from, focus);
    if (!sketch) this.hide();
    else if (this.at) this.draw();
  }

  /** The focus goes to the point that was just made, or stays. */
  private refocus(things: readonly Thing[], [x, y]: Place, focus: Element): void {
    const k = things.findIndex(({ kind, at }) => kind === "point" && Math.hypot(at[0] - x, at[1] - y) < 0.5 * this.step);
    const named = focus.getAttribute("data-named");
    const same = things.findIndex(({ kind, name }) => `${kind} ${name}` === named);
    const handle = this.handles.children[k >= 0 ? k : same] as SVGElement | undefined;
    (handle ?? this.page!.places.drawing.element).focus();
  }

  /** Forget a line that is begun. */
  rest(): void {
    if (!this.down) return;
    this.down = false;
    this.send("pointercancel");
  }

  private make(things: readonly Thing[], names: string): void {
    this.handles.dataset.names = names;
    this.handles.replaceChildren();
    for (const { kind, name } of things) {
      const named = `${kind} ${name}`;
      const handle = svg("circle", { class: "lw-focusable", tabindex: 0, role: "button", "data-named": named }, this.handles);
      if (kind === "point") handle.setAttribute("data-sketched", name);
    }
  }

  private focused(target: Element): void {
    const [kind, name] = (target.getAttribute("data-named") ?? "").split(" ") as [Chosen["kind"], string | undefined];
    if (name === undefined) {
      if (!this.at) this.move(this.middle());
      return;
    }
    this.move([Number(target.getAttribute("cx")), -Number(target.getAttribute("cy"))]);
    if (this.tool === "select" && !this.down) this.hooks.choose({ kind, name });
  }

  private middle(): Place {
    const [left, bottom, right, top] = this.page!.places.drawing.view as [number, number, number, number];
    const round = (value: number): number => (this.step ? 10 * this.step * Math.round(value / (10 * this.step)) : value);
    return [round((left + right) / 2), round((bottom + top) / 2)];
  }

  private move(at: Place): void {
    this.at = at;
    this.draw();
    this.send("pointermove");
  }

  private readonly commands: readonly Command[] = [
    {
      keys: Object.keys(ARROWS),
      does: "Move the cross, and the end of what is being drawn; with Shift ten times as far",
      when: () => this.at !== null && (this.down || this.tool !== "select"),
      act: (event) => {
        const far = this.step * (event.shiftKey ? 10 : 1);
        const [dx, dy] = ARROWS[event.key]!;
        this.move([this.at![0] + dx * far, this.at![1] + dy * far]);
      },
    },
    {
      keys: ["Enter"],
      does: "Begin at the cross or the focused point; then drop there",
      when: () => this.at !== null && (this.down || this.tool !== "select"),
      act: () => this.enter(),
    },
  ];

  private enter(): void {
    if (!this.down) this.send("pointerdown");
    if (!this.down && !this.hooks.clicks()) {
      this.down = true;
      this.hooks.hint("Arrow keys move the end, Tab goes to the next point; Enter drops it, Escape forgets it.");
      return;
    }
    this.down = false;
    this.send("pointerup");
  }

  /** What a pointer would send from there. */
  private send(kind: string): void {
    const { element } = this.page!.places.drawing;
    const matrix = element.getScreenCTM();
    if (!matrix || !this.at) return;
    const { x, y } = new DOMPoint(this.at[0], -this.at[1]).matrixTransform(matrix);
    element.dispatchEvent(new PointerEvent(kind, { clientX: x, clientY: y, pointerId: ID, pointerType: "mouse", button: 0, bubbles: true, cancelable: true }));
  }

  private draw(): void {
    const [x, y] = this.at!;
    const far = 14 * this.page!.places.drawing.pixel;
    put(this.cross, { d: `M${x - far} ${-y}H${x + far}M${x} ${-y - far}V${-y + far}` });
  }

  private hide(): void {
    this.at = null;
    put(this.cross, { d: "" });
  }
}

const round = (value: number): number => Number(value.toPrecision(5));

/** The points and links of a sketch, each with its place and its name. */
function thingsOf({ points, links }: Sketch): Thing[] {
  const named = Object.entries(points).map(([name, at]) => ({ kind: "point" as const, name, at, told: `Point ${name} at ${round(at[0])}, ${round(at[1])}` }));
  const between = links.flatMap(({ name, points: own }): Thing[] => {
    const [one, other] = own.flatMap((point) => (points[point] ? [points[point]!] : []));
    if (name === "ground" || !one || !other) return [];
    return [{ kind: "link", name, at: [(one[0] + other[0]) / 2, (one[1] + other[1]) / 2], told: `Link ${name} through ${own.join(", ")}` }];
  });
  return [...named, ...between];
}
