// A palette of what a mechanism is made of, the input, and the text of the file.

import type { FileState, LiveEdit } from "../messages";
import { html } from "../svg";
import type { Desk } from "./asking";
import { typed } from "./ranges";

/** One thing to fill in: a name or number to type, or points and links to choose. */
interface Field {
  readonly label: string;
  readonly kind: "text" | "number" | "point" | "link" | "points";
  readonly optional?: boolean;
}

type Values = Readonly<Record<string, string>>;

interface Piece {
  readonly title: string;
  readonly fields: readonly Field[];
  readonly edit: (values: Values) => LiveEdit;
}

const names = (text: string): string[] => text.split(/[\s,]+/).filter(Boolean);
const number = (text: string): number => Number(text.replace("\u2212", "-").replace(",", "."));

export const PIECES: readonly Piece[] = [
  {
    title: "Point",
    fields: [
      { label: "Name", kind: "text" },
      { label: "x", kind: "number" },
      { label: "y", kind: "number" },
      { label: "On link", kind: "link", optional: true },
    ],
    edit: (v) => ({ kind: "add_point", name: v.Name!, x: number(v.x!), y: number(v.y!), links: v["On link"] ? [v["On link"]] : [] }),
  },
  {
    title: "Link",
    fields: [
      { label: "Name", kind: "text" },
      { label: "Points", kind: "points" },
    ],
    edit: (v) => ({ kind: "add_link", name: v.Name!, points: names(v.Points!) }),
  },
  {
    title: "Joint",
    fields: [
      { label: "Link", kind: "link" },
      { label: "Point", kind: "point" },
    ],
    edit: (v) => ({ kind: "add_joint", link: v.Link!, point: v.Point! }),
  },
  {
    title: "Slider",
    fields: [
      { label: "Name", kind: "text" },
      { label: "Link", kind: "link" },
      { label: "Its points", kind: "points" },
      { label: "Slides on", kind: "link" },
      { label: "Along line", kind: "points" },
    ],
    edit: (v) => ({
      kind: "add_slider",
      name: v.Name!,
      link: v.Link!,
      points: names(v["Its points"]!),
      on: v["Slides on"]!,
      line: names(v["Along line"]!),
    }),
  },
  {
    title: "Gear pair",
    fields: [
      { label: "Name", kind: "text" },
      { label: "First wheel", kind: "link" },
      { label: "Second wheel", kind: "link" },
      { label: "Centres", kind: "points" },
      { label: "Radii or teeth", kind: "text" },
      { label: "Arm", kind: "link", optional: true },
    ],
    edit: (v) => ({
      kind: "add_gear",
      name: v.Name!,
      wheels: [v["First wheel"]!, v["Second wheel"]!],
      centers: names(v.Centres!),
      ...sizes(v["Radii or teeth"]!),
      ...(v.Arm ? { arm: v.Arm } : {}),
    }),
  },
];

/** "20 40" are radii, "20 40 teeth" teeth. */
export function sizes(text: string): { teeth: number[] } | { radii: number[] } {
  const numbers = names(text).map(number).filter(Number.isFinite);
  return /teeth/i.test(text) ? { teeth: numbers } : { radii: numbers };
}

export class Build {
  readonly element = html("div", { class: "lw-build" });
  private readonly input: HTMLElement;
  private readonly palette: HTMLElement;
  private readonly parts: HTMLElement;
  private readonly text: HTMLTextAreaElement;
  private readonly collect: HTMLInputElement;
  private readonly waiting: HTMLElement;
  private collected: LiveEdit[] = [];

  constructor(private readonly desk: Desk) {
    this.input = this.group("Input", true);
    this.palette = this.group("Add", true);
    const label = html("label", { class: "lw-toggle", title: "What stands between several changes need not be a mechanism" });
    this.collect = html("input", { type: "checkbox" }, label);
    label.append("Collect changes, then make them as one");
    this.waiting = html("div", { class: "lw-waiting" });
    this.palette.append(label, this.waiting);
    this.collect.addEventListener("change", () => this.pending());
    this.parts = this.group("Remove", false);
    const box = this.group("Text of the file", false);
    this.text = html("textarea", { rows: 18, spellcheck: "false", "aria-label": "Text of the file" }, box);
    const apply = html("button", { type: "button" }, box, "Use this text");
    apply.addEventListener("click", () => desk.ask({ kind: "set_text", text: this.text.value }));
  }

  show(file: FileState): void {
    this.text.value = file.text;
    this.inputs(file);
    this.pieces(file);
    this.removable(file);
  }

  private group(title: string, open: boolean): HTMLElement {
    const box = html("details", { class: "lw-group", ...(open ? { open: "" } : {}) }, this.element);
    html("summary", {}, box, title);
    return box;
  }

  private make(edit: LiveEdit): void {
    if (!this.collect.checked) {
      this.desk.ask(edit);
      return;
    }
    this.collected.push(edit);
    this.pending();
  }

  private pending(): void {
    this.waiting.replaceChildren();
    if (!this.collect.checked) this.collected = [];
    if (!this.collected.length) return;
    const list = html("ol", {}, this.waiting);
    for (const edit of this.collected) html("li", {}, list, described(edit));
    const apply = html("button", { type: "button", class: "lw-wanted lw-save" }, this.waiting, `Make ${this.collected.length} as one`);
    apply.addEventListener("click", () => {
      this.desk.ask({ kind: "together", edits: this.collected });
      this.collected = [];
      this.pending();
    });
    const drop = html("button", { type: "button" }, this.waiting, "Forget them");
    drop.addEventListener("click", () => {
      this.collected = [];
      this.pending();
    });
  }

  private inputs(file: FileState): void {
    this.input.querySelectorAll("form").forEach((form) => form.remove());
    file.inputs.forEach((one, k) => {
      const form = html("form", { class: "lw-form" }, this.input);
      html("strong", {}, form, `${one.drive} ${one.name}`);
      const unit = one.unit ? ` [${one.unit}]` : "";
      const step = one.rows > 1 ? (one.stop - one.start) / (one.rows - 1) : 1;
      const start = field(form, `From${unit}`, String(one.start));
      const stop = field(form, `To${unit}`, String(one.stop));
      const by = field(form, `Step${unit}`, String(Number(step.toPrecision(8))));
      const speed = field(form, "Speed", one.speed);
      html("button", { type: "submit" }, form, "Set the input");
      form.addEventListener("submit", (event) => {
        event.preventDefault();
        this.make({
          kind: "set_input",
          number: k,
          start: typed(start.value),
          stop: typed(stop.value),
          step: typed(by.value),
          ...(speed.value.trim() ? { speed: typed(speed.value) } : {}),
        });
      });
    });
  }

  private pieces(file: FileState): void {
    this.palette.querySelectorAll("details, p").forEach((old) => old.remove());
    const sketched = file.form === "points-and-links";
    if (!sketched) html("p", { class: "lw-empty" }, this.palette, "Equations are added in the text of the file.");
    for (const piece of sketched ? [...PIECES].reverse() : []) {
      const box = html("details", { class: "lw-piece" });
      this.palette.querySelector("summary")!.after(box);
      html("summary", {}, box, piece.title);
      const form = html("form", { class: "lw-form" }, box);
      const entries = piece.fields.map((one) => [one.label, entry(form, one, file)] as const);
      html("button", { type: "submit" }, form, `Add ${piece.title.toLowerCase()}`);
      form.addEventListener("submit", (event) => {
        event.preventDefault();
        this.make(piece.edit(Object.fromEntries(entries.map(([label, read]) => [label, read()]))));
      });
    }
  }

  private removable(file: FileState): void {
    this.parts.querySelectorAll("div").forEach((old) => old.remove());
    const box = html("div", { class: "lw-parts" }, this.parts);
    const chip = (text: string, edit: LiveEdit): void => {
      const button = html("button", { type: "button", "aria-label": `Remove ${text}` }, box, `${text} ×`);
      button.addEventListener("click", () => this.make(edit));
    };
    for (const link of file.links) {
      chip(`link ${link.name}`, { kind: "remove_link", name: link.name });
    }
    for (const point of Object.keys(file.points)) chip(`point ${point}`, { kind: "remove_point", name: point });
    const sliders = new Set(file.numbers.filter((one) => one.table === "sliders").map((one) => one.name.replace(/\.\w+$/, "")));
    for (const name of sliders) chip(`slider ${name}`, { kind: "remove_part", name });
  }
}

function field(form: Element, label: string, value: string): HTMLInputElement {
  const holder = html("label", {}, form, label);
  const input = html("input", { type: "text", autocomplete: "off", spellcheck: "false" }, holder);
  input.value = value;
  return input;
}

/** A field of a piece, and what reads it. */
function entry(form: Element, one: Field, file: FileState): () => string {
  if (one.kind === "text" || one.kind === "number") {
    const input = field(form, one.label, "");
    input.required = !one.optional;
    return () => input.value.trim();
  }
  const points = Object.keys(file.points);
  if (one.kind === "points") {
    const box = html("fieldset", { class: "lw-points" }, form);
    html("legend", {}, box, one.label);
    const chosen: string[] = [];
    for (const point of points) {
      const label = html("label", { class: "lw-toggle" }, box);
      const check = html("input", { type: "checkbox" }, label);
      label.append(point);
      check.addEventListener("change", () => {
        if (check.checked) chosen.push(point);
        else chosen.splice(chosen.indexOf(point), 1);
      });
    }
    return () => chosen.join(" ");
  }
  const select = html("select", {}, html("label", {}, form, one.label));
  const listed = one.kind === "point" ? points : file.links.map((link) => link.name);
  for (const name of [...(one.optional ? [""] : []), ...listed]) html("option", { value: name }, select, name || "none");
  return () => select.value;
}

/** A change in a few words. */
export function described(edit: LiveEdit): string {
  const what = edit.kind.replace("_", " ");
  const fields = edit as unknown as Readonly<Record<string, unknown>>;
  return `${what} ${String(fields.name ?? fields.point ?? "")}`.trim();
}
