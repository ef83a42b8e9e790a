// A photograph behind the drawing, scaled by one known length; it stays in the browser.

import type { FileState } from "../../messages";
import type { Mounted } from "../../mount";
import { html, pathOf, put, svg } from "../../svg";
import type { Desk } from "../asking";
import { typed } from "../ranges";
import { distance, type Place } from "./geometry";
import { iconButton } from "./icon_button";

const KEPT = "linkwork-photograph";
/** Sides of a kept picture [px]: storage is small. */
const LARGEST = 1600;

/** A picture in the plane: its left upper corner, its size [length], and how much of it is seen. */
export interface Picture {
  readonly data: string;
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
  readonly opacity: number;
}

/** The picture at such a scale that a line on it has a length; the line's first end stays. */
export function scaled(picture: Picture, from: Place, to: Place, length: number): Picture {
  const factor = length / distance(from, to);
  return {
    ...picture,
    x: from[0] + factor * (picture.x - from[0]),
    y: from[1] + factor * (picture.y - from[1]),
    width: factor * picture.width,
    height: factor * picture.height,
  };
}

type Points = Readonly<Record<string, readonly [number, number]>>;
type Dragged = "" | "move" | "scale";

export class Photograph {
  readonly button = iconButton("Photograph behind the drawing", "Photograph behind the drawing", "M4 5h16v14H4zM4 16l5-5 4 4 2.500-2.500L20 17M15.500 9m-1.200 0a1.200 1.200 0 1 0 2.400 0a1.200 1.200 0 1 0-2.400 0");
  private readonly image = svg("image", { class: "lw-photograph", preserveAspectRatio: "none" });
  private readonly line = svg("path", { class: "lw-measure-line" });
  private readonly panel = html("section", { class: "lw-photo", "aria-label": "Photograph", hidden: "" });
  private readonly file = html("input", { type: "file", accept: "image/*", "aria-label": "Choose a picture" });
  private readonly opacity = html("input", { type: "range", min: 0.05, max: 1, step: 0.05, "aria-label": "Opacity" });
  private readonly length = html("input", { type: "text", "aria-label": "Length of the line", autocomplete: "off", hidden: "" });
  private readonly note = html("p", { class: "lw-lead", role: "status" });
  private readonly with: readonly HTMLElement[];
  private page: Mounted | null = null;
  private picture: Picture | null = null;
  private state: FileState | null = null;
  private dragging: Dragged = "";
  private ends: readonly [Place, Place] | null = null;

  constructor(private readonly desk: Desk) {
    this.button.addEventListener("click", () => this.open(this.panel.hidden));
    const head = html("header", {}, this.panel);
    html("strong", {}, head, "Photograph");
    html("button", { type: "button", class: "lw-close", "aria-label": "Close" }, head, "×").addEventListener("click", () => this.open(false));
    this.panel.append(this.file, this.note);
    this.file.addEventListener("change", () => this.file.files?.[0] && void this.take(this.file.files[0]));
    const box = html("div", { class: "lw-inspected-actions" }, this.panel);
    const button = (label: string, act: () => void): void => html("button", { type: "button" }, box, label).addEventListener("click", act);
    button("Scale", () => this.drag("scale", "Drag a line on the picture whose length you know."));
    button("Place", () => this.drag("move", "Drag the picture to its place."));
    button("Remove", () => this.set(null));
    const seen = html("label", {}, this.panel, "Opacity");
    seen.append(this.opacity);
    this.opacity.addEventListener("input", () => this.picture && this.set({ ...this.picture, opacity: Number(this.opacity.value) }));
    this.panel.append(this.length);
    this.length.addEventListener("change", () => this.scale());
    this.with = [box, seen];
    this.panel.addEventListener("pointerdown", (event) => event.stopPropagation());
  }

  attach(page: Mounted, signal: AbortSignal): void {
    this.page = page;
    const { canvas, drawing } = page.places;
    drawing.element.prepend(this.image);
    drawing.element.append(this.line);
    canvas.append(this.panel);
    canvas.addEventListener("dragover", (event) => event.preventDefault(), { signal });
    canvas.addEventListener("drop", (event) => this.dropped(event, event.dataTransfer), { signal });
    document.addEventListener("paste", (event) => this.dropped(event, event.clipboardData), { signal });
    this.renew();
    this.draw();
  }

  /** Another file has another picture. */
  renew(): void {
    const state = this.desk.file();
    const before = this.state;
    if (state === before) return;
    this.state = state;
    if (state.file !== before?.file) this.picture = kept(state.file);
    else if (this.picture && state.length_unit !== before.length_unit) {
      const factor = growth(before.points, state.points);
      const { x, y, width, height } = this.picture;
      this.set({ ...this.picture, x: factor * x, y: factor * y, width: factor * width, height: factor * height });
    }
    this.draw();
  }

  /** A pointer on the drawing; whether the picture takes it. */
  press(event: PointerEvent): boolean {
    if (!this.dragging || !this.picture || !this.page) return false;
    const { drawing } = this.page.places;
    const start = drawing.placeAt(event);
    const before = this.picture;
    const gone = new AbortController();
    const move = (now: PointerEvent): void => {
      const at = drawing.placeAt(now);
      if (this.dragging === "move") this.set({ ...before, x: before.x + at[0] - start[0], y: before.y + at[1] - start[1] }, false);
      else this.ends = [start, at];
      this.draw();
    };
    document.addEventListener("pointermove", move, { capture: true, signal: gone.signal });
    document.addEventListener("pointerup", (now) => {
      gone.abort();
      move(now);
      this.dragged();
    }, { capture: true, signal: gone.signal });
    return true;
  }

  private dragged(): void {
    if (this.dragging === "move") {
      this.set(this.picture);
      this.drag("", "");
    } else if (this.ends && distance(...this.ends) > 0) {
      const unit = this.desk.file().length_unit;
      this.note.textContent = `Its length${unit ? ` [${unit}]` : ""}:`;
      this.length.hidden = false;
      this.length.value = "";
      this.length.focus();
    }
  }

  private scale(): void {
    const length = typed(this.length.value);
    if (!this.picture || !this.ends || typeof length !== "number" || !(length > 0)) {
      this.note.textContent = `A length is a positive number, in ${this.desk.file().length_unit || "the unit of the file"}.`;
      return;
    }
    this.set(scaled(this.picture, ...this.ends, length));
    this.drag("", "");
  }

  private drag(what: Dragged, note: string): void {
    this.dragging = what;
    this.ends = null;
    this.length.hidden = true;
    this.note.textContent = note;
    this.panel.dataset.dragging = what;
    this.page?.places.canvas.classList.toggle("lw-measuring", what !== "");
    this.draw();
  }

  private open(on: boolean): void {
    this.panel.hidden = !on;
    put(this.button, { "aria-pressed": String(on) });
    this.drag("", "");
  }

  private dropped(event: Event, data: DataTransfer | null): void {
    const file = Array.from(data?.files ?? []).find(({ type }) => type.startsWith("image/"));
    if (!file || (event.target as Element).closest("input, textarea")) return;
    event.preventDefault();
    void this.take(file);
  }

  /** Put a picture into the visible part of the plane. */
  private async take(file: File): Promise<void> {
    this.open(true);
    try {
      const { data, ratio } = await reduced(file);
      const { x, y, width } = this.page!.places.drawing.window;
      const [w, h] = [0.8 * width, 0.8 * width * ratio];
      this.set({ data, x: x - w / 2, y: y + h / 2, width: w, height: h, opacity: 0.5 });
      this.note.textContent = "Scale it by one known length, then place it.";
    } catch {
      this.note.textContent = `"${file.name}" is not a picture that this browser can read.`;
    }
    this.file.value = "";
  }

  private set(picture: Picture | null, last = true): void {
    this.picture = picture;
    if (last && !keep(this.desk.file().file, picture)) this.note.textContent = "The browser does not keep the picture: it is gone when the page closes.";
    if (picture === null) this.drag("", "");
    this.draw();
  }

  draw(): void {
    for (const element of this.with) element.hidden = this.picture === null;
    put(this.line, { d: this.ends ? pathOf([...this.ends[0], ...this.ends[1]], false) : "" });
    if (this.picture === null) {
      this.image.remove();
      return;
    }
    const { data, x, y, width, height, opacity } = this.picture;
    if (!this.image.isConnected) this.page?.places.drawing.element.prepend(this.image);
    put(this.image, { href: data, x, y: -y, width, height, opacity });
    this.opacity.value = String(opacity);
  }
}

/** By how much coordinates have grown, as when units are converted. */
export function growth(before: Points, after: Points): number {
  for (const [name, [x, y]] of Object.entries(before)) {
    const far = Math.hypot(x, y);
    if (far > 0 && after[name]) return Math.hypot(...after[name]!) / far;
  }
  return 1;
}

/** A picture small enough to be kept, as a data URL, with its height by its width. */
async function reduced(file: File): Promise<{ data: string; ratio: number }> {
  const url = await new Promise<string>((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(String(reader.result));
    reader.onerror = () => reject(reader.error);
    reader.readAsDataURL(file);
  });
  const image = new Image();
  image.src = url;
  await image.decode();
  const share = Math.min(1, LARGEST / Math.max(image.naturalWidth, image.naturalHeight, 1));
  const canvas = document.createElement("canvas");
  canvas.width = Math.max(1, Math.round(share * (image.naturalWidth || LARGEST)));
  canvas.height = Math.max(1, Math.round(share * (image.naturalHeight || LARGEST)));
  canvas.getContext("2d")!.drawImage(image, 0, 0, canvas.width, canvas.height);
  return { data: canvas.toDataURL("image/webp", 0.8), ratio: canvas.height / canvas.width };
}

/** Storage may be forbidden, as in a sandboxed frame, or full. */
function kept(name: string): Picture | null {
  try {
    return JSON.parse(localStorage.getItem(`${KEPT} ${name}`) ?? "null") as Picture | null;
  } catch {
    return null;
  }
}

function keep(name: string, picture: Picture | null): boolean {
  try {
    if (picture === null) localStorage.removeItem(`${KEPT} ${name}`);
    else localStorage.setItem(`${KEPT} ${name}`, JSON.stringify(picture));
    return true;
  } catch {
    return false;
  }
}
