// Forms for masses, gravity, friction, motors and stops: in the list of all, and at what is selected.

import type { EntryShown, FileState, MassShown, PaletteForm } from "../messages";
import { html } from "../svg";
import type { Desk } from "./asking";
import { typed } from "./ranges";

/** Fields that are rarely filled. */
const RARE = new Set(["speeds", "torques"]);

const EXAMPLES: Readonly<Record<string, string>> = { size: "9.81 m/s^2", angle: "downwards", free_speed: "1500 rpm", speeds: "0 rpm, 1500 rpm", torques: "12, 0", of: "a link, a slider, B.x", restitution: "0" };

interface Shown {
  readonly key: string;
  readonly label: string;
  readonly value: string;
  readonly doc?: string;
  readonly rare?: boolean;
}

export class ForceForms {
  /** The forms of loads that are no parts. */
  kinds: readonly PaletteForm[] = [];

  constructor(private readonly desk: Desk) {}

  /** The form for the mass of a link; an empty one has none. */
  mass(box: Element, own: MassShown, file: FileState): void {
    const { link, mass, x, y, inertia } = own;
    const [length, unit] = [file.length_unit, file.mass_unit];
    const fields: readonly Shown[] = [
      { key: "mass", label: `Mass [${unit}]`, value: mass },
      { key: "x", label: `Centre x [${length}]`, value: x },
      { key: "y", label: `Centre y [${length}]`, value: y },
      { key: "inertia", label: `Inertia [${unit} ${length}²]`, value: inertia },
    ];
    this.form(box, `Mass of ${link}`, `Set the mass of ${link}`, fields, (given) => {
      const numbers = Object.fromEntries(Object.entries(given).map(([key, text]) => [key, typed(text)]));
      this.desk.ask({ kind: "set_mass", link, ...numbers });
    });
  }

  /** The forms of a table, one for each entry. */
  all(box: Element, table: string, file: FileState): void {
    for (const entry of file.force_entries) if (entry.table === table) this.entry(box, entry, file);
  }

  /** What loads a selected thing; whether there is anything to fill in. */
  at(box: Element, kind: "point" | "link" | "part", name: string, file: FileState): void {
    const mass = kind === "link" ? file.masses.find(({ link }) => link === name) : undefined;
    const own = file.force_entries.filter(({ table, of }) => (table === "friction" && kind !== "link" && of === name) || (table === "motor" && kind !== "point" && of === name));
    const bounded = kind !== "point" && file.drives.some((drive) => drive.name === name);
    const stops = bounded ? file.force_entries.filter(({ table, typed }) => table === "stops" && typed.of === name) : [];
    if (!mass && !own.length && !bounded) return;
    const more = html("details", { class: "lw-more lw-forces-at" }, box);
    const named = [...(mass ? ["mass"] : []), ...own.map(({ table }) => table), ...(bounded ? ["stops"] : [])];
    html("summary", {}, more, named.join(", ").replace(/^./, (letter) => letter.toUpperCase()));
    more.open = Boolean(mass?.mass) || own.some(({ there }) => there) || stops.length > 0;
    if (mass) this.mass(more, mass, file);
    for (const entry of own) this.entry(more, entry, file);
    const blank = file.force_entries.find(({ table, of }) => table === "stops" && !of);
    for (const entry of stops) this.entry(more, entry, file);
    if (bounded && blank && !stops.length) this.entry(more, { ...blank, typed: { of: name } }, file);
  }

  private entry(box: Element, entry: EntryShown, file: FileState): void {
    const kind = this.kinds.find(({ table }) => table === entry.table);
    if (!kind) return;
    const fields = kind.fields
      .filter(({ name }) => entry.takes.includes(name))
      .map(({ name, doc }) => ({ key: name, label: labelOf(name, entry, file), value: shown(entry.typed[name]), doc, rare: RARE.has(name) }));
    const title = titleOf(kind, entry);
    const lists = new Set(kind.fields.filter(({ entry: own }) => own === "numbers").map(({ name }) => name));
    const send = (given: Readonly<Record<string, string>>, remove: boolean): void => {
      const words = Object.fromEntries(Object.entries(given).map(([key, text]) => [key, lists.has(key) ? [text] : text]));
      this.desk.ask({ kind: "set_entry", table: entry.table, of: entry.of, typed: words, remove });
    };
    const lower = title.replace(/^./, (letter) => letter.toLowerCase());
    const button = entry.table === "stops" && !entry.there ? "Add stops" : `Set ${entry.there || entry.of ? "the " : ""}${lower}`;
    const form = this.form(box, title, button, fields, (given) => send(given, false));
    if (!entry.there) return;
    const remove = html("button", { type: "button", "aria-label": `Remove ${lower}` }, form, "Remove");
    remove.addEventListener("click", () => {
      form.dataset.sent = "";
      send(entry.table === "stops" ? { of: shown(entry.typed.of) } : {}, true);
    });
  }

  private form(box: Element, title: string, button: string, fields: readonly Shown[], send: (given: Readonly<Record<string, string>>) => void): HTMLFormElement {
    const form = html("form", { class: "lw-form lw-force-form", "aria-label": title }, box);
    html("p", { class: "lw-wide" }, form, title);
    const rare = fields.some((one) => one.rare) ? html("details", { class: "lw-more" }) : null;
    if (rare) html("summary", {}, rare, "More");
    const inner = rare && html("div", { class: "lw-form" }, rare);
    const inputs = fields.map(({ key, label, value, doc = "", rare: seldom }) => {
      const holder = html("label", { title: doc }, seldom ? inner! : form, label);
      const input = html("input", { type: "text", autocomplete: "off", spellcheck: "false", "data-key": key, placeholder: EXAMPLES[key] ?? "" }, holder);
      input.value = input.defaultValue = value;
      if (seldom && value) rare!.open = true;
      return { key, input };
    });
    if (rare) form.append(rare);
    html("button", { type: "submit", "data-key": "", "aria-label": button }, form, button.split(" ")[0]);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      form.dataset.sent = "";
      send(Object.fromEntries(inputs.flatMap(({ key, input }) => (input.value.trim() ? [[key, input.value.trim()]] : []))));
    });
    return form;
  }
}

/** The forms of this module; fields of others have no default value. */
const OWN = "form.lw-force-form";

/** Build forms anew: what is typed into the others but not sent stays, and so does the focus. */
export function rebuilt(box: Element, build: () => void): void {
  const named = (form: Element): string => form.getAttribute("aria-label") ?? "";
  const kept = new Map<string, string>();
  for (const form of box.querySelectorAll<HTMLFormElement>(OWN)) {
    if (form.dataset.sent !== undefined) continue;
    for (const input of form.querySelectorAll("input")) if (input.value !== input.defaultValue) kept.set(`${named(form)} ${input.dataset.key}`, input.value);
  }
  const active = document.activeElement instanceof HTMLElement && box.contains(document.activeElement) ? document.activeElement : null;
  const own = active?.closest(OWN);
  const [at, key] = [own ? named(own) : null, active?.dataset.key ?? ""];
  build();
  for (const form of box.querySelectorAll(OWN)) {
    for (const input of form.querySelectorAll("input")) input.value = kept.get(`${named(form)} ${input.dataset.key}`) ?? input.value;
    if (named(form) === at) form.querySelector<HTMLElement>(`[data-key="${key}"]`)?.focus();
  }
}

function titleOf({ title, table }: PaletteForm, { of, typed, there }: EntryShown): string {
  if (table === "gravity") return title;
  if (table === "stops") return there ? `Stops of ${shown(typed.of)}, number ${Number(of) + 1}` : typed.of ? `Stops of ${shown(typed.of)}` : "New stops";
  return `${title} of ${of}`;
}

/** The label of a field with its unit. */
function labelOf(name: string, { table, of }: EntryShown, file: FileState): string {
  const [length, mass, force] = [file.length_unit, file.mass_unit, file.force_unit];
  const slides = ["slider", "cylinder"].includes(file.inputs.find((input) => input.name === of)?.drive ?? "");
  const effort = slides ? force : `${force}·${length}`;
  const units: Readonly<Record<string, string>> = {
    angle: file.angle_unit, radius: length, length, stall: effort, torques: effort, inertia: slides ? mass : `${mass} ${length}²`,
  };
  const words: Readonly<Record<string, string>> = { mu: "Coefficient μ", inertia: "Flywheel", stall: slides ? "Stall force" : "Stall torque", length: "Guided length", of: "Quantity", size: "Size" };
  const word = words[name] ?? name.replaceAll("_", " ").replace(/^./, (letter) => letter.toUpperCase());
  const unit = table === "stops" ? "" : units[name];
  return unit ? `${word} [${unit}]` : word;
}

const shown = (entry: string | readonly string[] | undefined): string => (entry === undefined ? "" : [entry].flat().join(", "));
