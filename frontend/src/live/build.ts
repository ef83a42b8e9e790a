// The palette of parts, the input, and the text of the file.

import type { DrivenInput, FileState, LiveEdit, PalettePart } from "../messages";
import { toggle } from "../controls";
import { html } from "../svg";
import type { Desk } from "./asking";
import { rebuilt, type ForceForms } from "./force_forms";
import { typed } from "./ranges";

/** A field of a form: a name or number to type, or points and links to choose. */
export interface Field {
  readonly name: string;
  readonly entry: string;
  readonly required: boolean;
  readonly doc?: string;
  readonly words?: readonly string[];
  readonly named?: readonly string[];
}

/** User input of a field: one entry or several. */
export type Entry = string | readonly string[];
type Entries = Readonly<Record<string, Entry>>;

export interface Piece {
  readonly title: string;
  readonly doc?: string;
  readonly fields: readonly Field[];
  readonly edit: (entries: Entries) => LiveEdit;
}

const one = (name: string, entry: string, required = true): Field => ({ name, entry, required });

const PLAIN: readonly Piece[] = [
  {
    title: "Point",
    doc: "x and y are its coordinates in the sketch of the file, the initial guess of the assembly",
    fields: [one("name", "text"), one("x", "number"), one("y", "number"), one("on link", "link", false)],
    edit: (v) => ({
      kind: "add_point",
      name: String(v.name),
      x: typed(String(v.x)),
      y: typed(String(v.y)),
      links: v["on link"] ? [String(v["on link"])] : [],
    }),
  },
  {
    title: "Link",
    fields: [one("name", "text"), one("points", "points")],
    edit: (v) => ({ kind: "add_link", name: String(v.name), points: v.points as string[] }),
  },
  {
    title: "Joint",
    fields: [one("link", "link"), one("point", "point")],
    edit: (v) => ({ kind: "add_joint", link: String(v.link), point: String(v.point) }),
  },
];

/** Points, links and joints, and all kinds of parts of files. */
export function piecesOf(parts: readonly PalettePart[]): readonly Piece[] {
  return [
    ...PLAIN,
    ...parts.map(({ table, title, doc, fields }) => ({ title, doc, fields, edit: (v: Entries): LiveEdit => partOf(table, v) })),
  ];
}

/** Optional fields that are usually given. */
const USUAL = new Set(["on link", "radii", "teeth"]);

/** The completed fields of a part; empty fields are omitted. */
export function partOf(table: string, entries: Entries): LiveEdit {
  const filled = Object.entries(entries).filter(([, entry]) => entry.length > 0);
  return { kind: "add_part", table, typed: Object.fromEntries(filled) };
}

export class Build {
  readonly element = html("div", { class: "lw-build" });
  private readonly input: HTMLElement;
  private readonly palette: HTMLElement;
  private readonly masses: HTMLElement;
  private readonly paths: HTMLElement;
  private readonly parts: HTMLElement;
  private readonly text: HTMLTextAreaElement;
  private readonly groups = new Map<string, HTMLDetailsElement>();
  private offered: readonly Piece[] = PLAIN;

  constructor(
    private readonly desk: Desk,
    private readonly forms: ForceForms,
  ) {
    this.input = this.group("Input", true);
    this.palette = this.group("Add", true);
    this.masses = this.group("Masses", false);
    for (const title of ["Gravity", "Friction", "Motor", "Stops"]) this.group(title, false);
    this.paths = this.group("Paths of points", false);
    this.parts = this.group("Remove", false);
    const box = this.group("Text of the file", false, "text");
    this.text = html("textarea", { rows: 18, spellcheck: "false", "aria-label": "Text of the file" }, box);
    const apply = html("button", { type: "button" }, box, "Use this text");
    apply.addEventListener("click", () => desk.ask({ kind: "set_text", text: this.text.value }));
  }

  offer(parts: readonly PalettePart[]): void {
    this.offered = piecesOf(parts);
  }

  show(file: FileState): void {
    this.text.value = file.text;
    this.inputs(file);
    this.pieces(file);
    this.loads(file);
    this.traces(file);
    this.removable(file);
  }

  /** Forms for masses, gravity, friction, motors and stops. */
  private loads(file: FileState): void {
    const lead = "The centre is in the frame of the link, from its first point towards its second. A link of two points without centre and inertia is a uniform rod.";
    rebuilt(this.element, () => {
      this.fill(this.masses, lead, () => file.masses.forEach((own) => this.forms.mass(this.masses, own, file)));
      for (const { table, doc } of this.forms.kinds) {
        const box = this.groups.get(table)!;
        this.fill(box, `${doc}.`, () => this.forms.all(box, table, file));
      }
    });
  }

  private fill(box: Element, lead: string, forms: () => void): void {
    box.querySelectorAll("form, p").forEach((old) => old.remove());
    html("p", { class: "lw-lead" }, box, lead);
    forms();
    if (!box.querySelector("form")) html("p", { class: "lw-empty" }, box, "Nothing here can have it yet.");
  }

  private traces(file: FileState): void {
    this.paths.querySelectorAll("div").forEach((old) => old.remove());
    const box = html("div", { class: "lw-parts" }, this.paths);
    for (const point of file.traceable) {
      toggle(box, point, file.traced.includes(point), (on) => this.desk.ask({ kind: "trace_point", point, on }));
    }
  }

  /** Open a group of forms, and choose its first field. */
  open(name: string): void {
    const box = this.groups.get(name);
    if (!box) return;
    box.open = true;
    box.scrollIntoView({ block: "nearest" });
    box.querySelector<HTMLElement>("input, select, textarea")?.focus();
  }

  private group(title: string, open: boolean, name = title.toLowerCase()): HTMLElement {
    const box = html("details", { class: "lw-group", ...(open ? { open: "" } : {}) }, this.element);
    html("summary", {}, box, title);
    this.groups.set(name, box);
    return box;
  }

  private inputs(file: FileState): void {
    this.input.querySelectorAll("form").forEach((form) => form.remove());
    const none = { name: "", drive: "", unit: "", start: NaN, stop: NaN, rows: 0, speed: "" };
    (file.inputs.length ? file.inputs : [none]).forEach((one, k) => this.inputForm(file, one, k));
  }

  private inputForm(file: FileState, one: DrivenInput, k: number): void {
    const form = html("form", { class: "lw-form" }, this.input);
    const drives = file.drives.map(({ kind, name }) => ({ text: `${kind} ${name}`, kind, name }));
    const now = drives.find(({ kind, name }) => kind === one.drive && name === one.name);
    const driven = html("select", {}, html("label", { class: "lw-wide" }, form, "Driven"));
    if (!now) html("option", { value: "" }, driven, one.name ? `${one.drive} ${one.name}` : "nothing yet");
    drives.forEach(({ text }) => html("option", { value: text }, driven, text));
    driven.value = now?.text ?? "";
    const unit = one.unit ? ` [${one.unit}]` : "";
    const step = one.rows > 1 ? (one.stop - one.start) / (one.rows - 1) : NaN;
    const shown = (value: number): string => (Number.isFinite(value) ? String(Number(value.toPrecision(8))) : "");
    const fields = [
      { key: "start", label: `From${unit}`, value: shown(one.start) },
      { key: "stop", label: `To${unit}`, value: shown(one.stop) },
      { key: "step", label: `Step${unit}`, value: shown(step) },
      { key: "speed", label: "Speed", value: one.speed },
    ].map(({ key, label, value }) => ({ key, value, input: field(form, label, value) }));
    html("button", { type: "submit" }, form, "Set the input");
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const wanted = drives.find(({ text }) => text === driven.value);
      const changed = fields.filter(({ value, input }) => input.value.trim() && input.value !== value);
      this.desk.ask({
        kind: "set_input",
        number: k,
        ...(wanted && wanted !== now ? { drive: wanted.kind, name: wanted.name } : {}),
        ...Object.fromEntries(changed.map(({ key, input }) => [key, typed(input.value)])),
      });
    });
  }

  private pieces(file: FileState): void {
    const open = Array.from(this.palette.querySelectorAll(".lw-piece[open] > summary"), (one) => one.textContent);
    this.palette.querySelectorAll("details, p").forEach((old) => old.remove());
    const sketched = file.form === "points-and-links";
    if (!sketched) html("p", { class: "lw-empty" }, this.palette, "To add equations, edit the text of the file.");
    for (const piece of sketched ? [...this.offered].reverse() : []) {
      const box = html("details", { class: "lw-piece" });
      this.palette.querySelector("summary")!.after(box);
      html("summary", {}, box, piece.title);
      box.open = open.includes(piece.title);
      // created when opened: most are never used
      box.addEventListener("toggle", () => box.open && box.childElementCount === 1 && this.form(box, piece, file));
    }
  }

  private form(box: HTMLElement, piece: Piece, file: FileState): void {
    const form = html("form", { class: "lw-form" }, box);
    if (piece.doc) html("p", { class: "lw-lead" }, form, `${piece.doc}.`);
    const first = (one: Field): boolean => one.required || USUAL.has(one.name);
    const rest = piece.fields.some((one) => !first(one)) ? html("details", { class: "lw-more" }) : null;
    if (rest) html("summary", {}, rest, "More");
    const more = rest && html("div", { class: "lw-form" }, rest);
    const entries = piece.fields.map((one) => [one.name, entry(first(one) ? form : more!, one, file)] as const);
    if (rest) form.append(rest);
    html("button", { type: "submit" }, form, `Add ${piece.title.toLowerCase()}`);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.desk.ask(piece.edit(Object.fromEntries(entries.map(([name, read]) => [name, read()]))));
    });
  }

  private removable(file: FileState): void {
    this.parts.querySelectorAll("div").forEach((old) => old.remove());
    const box = html("div", { class: "lw-parts" }, this.parts);
    const chip = (text: string, edit: LiveEdit): void => {
      const button = html("button", { type: "button", "aria-label": `Remove ${text}` }, box, `${text} ×`);
      button.addEventListener("click", () => this.desk.ask(edit));
    };
    for (const link of file.links) {
      chip(`link ${link.name}`, { kind: "remove_link", name: link.name });
    }
    for (const point of Object.keys(file.points)) chip(`point ${point}`, { kind: "remove_point", name: point });
    for (const name of file.parts) chip(name, { kind: "remove_part", name });
  }
}

function field(form: Element, label: string, value: string): HTMLInputElement {
  const holder = html("label", {}, form, label);
  const input = html("input", { type: "text", autocomplete: "off", spellcheck: "false" }, holder);
  input.value = value;
  return input;
}

/** A field of a form, and the function that reads it. */
function entry(form: Element, what: Field, file: FileState): () => Entry {
  const { name, entry: kind, required, doc = "", words = [], named = [] } = what;
  const label = name.replaceAll("_", " ");
  const points = Object.keys(file.points);
  const links = file.links.map((link) => link.name);
  const sliders = file.drives.filter((drive) => drive.kind === "slider").map((drive) => drive.name);
  const lengths = file.drives.filter(({ kind }) => kind === "slider" || kind === "cylinder").map(({ name }) => name);
  const listed = { point: points, link: links, slider: sliders, length: lengths, choice: words }[kind];
  if (listed) {
    const select = html("select", {}, html("label", { title: doc }, form, label));
    for (const word of [...(required ? [] : [""]), ...listed]) html("option", { value: word }, select, word || "none");
    return () => select.value;
  }
  const several = { points, links, lengths }[kind];
  if (several) {
    const box = html("fieldset", { class: "lw-points", title: doc }, form);
    html("legend", {}, box, label);
    const chosen: string[] = [];
    for (const word of several) {
      const toggle = html("label", { class: "lw-toggle" }, box);
      const check = html("input", { type: "checkbox" }, toggle);
      toggle.append(word);
      check.addEventListener("change", () => {
        if (check.checked) chosen.push(word);
        else chosen.splice(chosen.indexOf(word), 1);
      });
    }
    return () => [...chosen];
  }
  if (kind === "flag") {
    const toggle = html("label", { class: "lw-toggle", title: doc }, form);
    const check = html("input", { type: "checkbox" }, toggle);
    toggle.append(label);
    return () => (check.checked ? "true" : "");
  }
  if (kind === "lines") {
    const holder = html("label", { class: "lw-wide", title: doc }, form, `${label}: ${named.join(", ")} in each line`);
    const area = html("textarea", { rows: 4, spellcheck: "false" }, holder);
    return () => area.value.split("\n").filter((line) => line.trim());
  }
  const input = field(form, label, "");
  input.required = required;
  input.parentElement!.title = doc;
  if (kind !== "numbers") return () => input.value.trim();
  input.placeholder = "20, 40";
  return () => [input.value].filter((text) => text.trim());
}
