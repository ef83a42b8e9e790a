// The panel at a selected part: its entries as typed fields, its links, and what can be done with it.

import type { FileState, LiveEdit, PaletteField, PalettePart, PartShown } from "../../messages";
import { html } from "../../svg";
import type { Desk } from "../asking";
import { fill } from "../fields";
import { driving } from "./tool_edits";

/** Entries that name other things. */
const NAMES = new Set(["point", "points", "link", "links", "slider", "length", "lengths"]);

type Entry = string | readonly string[] | undefined;

export class PartPanel {
  /** The kinds of parts. */
  kinds: readonly PalettePart[] = [];

  constructor(
    private readonly desk: Desk,
    private readonly goTo: (link: string) => void,
  ) {}

  /** Write the fields of a part into a box. */
  show(box: Element, part: PartShown): void {
    const fields = this.fields(part);
    const names = fields.filter(({ entry }) => NAMES.has(entry));
    html("p", { class: "lw-lead" }, box, names.flatMap(({ name }) => (part.typed[name] ? [`${name}: ${[part.typed[name]].flat().join(", ")}`] : [])).join(" · "));
    const own = fields.filter(({ entry, name }) => !NAMES.has(entry) && name !== "name");
    const usual = own.filter((field) => this.isUsual(field, part));
    for (const field of usual) this.field(box, field, part);
    const rest = own.filter((field) => !usual.includes(field));
    if (rest.length) {
      const more = html("details", { class: "lw-more" }, box);
      html("summary", {}, more, "More");
      for (const field of rest) this.field(more, field, part);
    }
    const links = html("div", { class: "lw-inspected-actions" }, box);
    for (const link of part.links) {
      if (link === "ground") continue;
      const button = html("button", { type: "button" }, links, `Link ${link}`);
      button.addEventListener("click", () => this.goTo(link));
    }
  }

  /** Other entries of the same part, but for the field being typed in. */
  refresh(box: Element, part: PartShown): void {
    for (const input of box.querySelectorAll<HTMLInputElement | HTMLTextAreaElement>("[data-entry]")) {
      const entry = part.typed[input.dataset.entry!];
      if (input.type === "checkbox") (input as HTMLInputElement).checked = entry === "true";
      else if (input instanceof HTMLTextAreaElement) input.value = shown(entry);
      else fill(input as HTMLInputElement, shown(entry));
    }
  }

  /** What can be done with a part. */
  actions(part: PartShown, file: FileState): { label: string; edits: LiveEdit[]; reason?: string }[] {
    const drive = file.drives.find(({ kind, name }) => kind !== "link" && name === part.name);
    const driven = file.inputs.some(({ name }) => name === part.name);
    const reason = driven ? "it is driven already" : drive ? "" : "drive one of its links";
    return [
      { label: "Drive", edits: drive ? [driving(file, drive.kind, drive.name)] : [], ...(reason ? { reason } : {}) },
      { label: "Delete", edits: [{ kind: "remove_part", name: part.name, whole: true }] },
    ];
  }

  /** The heading of the panel. */
  title(part: PartShown): string {
    return `${this.kinds.find(({ table }) => table === part.table)?.title ?? "Part"} ${part.name}`;
  }

  private fields(part: PartShown): readonly PaletteField[] {
    return this.kinds.find(({ table }) => table === part.table)?.fields ?? [];
  }

  private isUsual({ name, entry }: PaletteField, part: PartShown): boolean {
    return name in part.typed || entry === "flag" || entry === "choice" || ["radii", "teeth", "offset", "stiffness", "free", "damping"].includes(name);
  }

  private field(box: Element, field: PaletteField, part: PartShown): void {
    const { name, doc, entry, words } = field;
    const row = html("div", { class: "lw-inspected lw-entry", title: doc }, box);
    const label = html("label", {}, row, name.replaceAll("_", " "));
    const now = part.typed[name];
    const send = (typed: string | string[]): void => void this.desk.ask({ kind: "set_part", name: part.name, key: name, typed });
    if (entry === "flag") {
      const check = html("input", { type: "checkbox", "data-entry": name }, label);
      check.checked = now === "true";
      const reason = name === "internal" && part.typed.radii ? "give teeth instead of radii first" : "";
      check.disabled = reason !== "";
      if (reason) row.title = `Not possible: ${reason}`;
      check.addEventListener("change", () => send(check.checked ? "true" : ""));
    } else if (entry === "choice") {
      const select = html("select", { "data-entry": name }, label);
      for (const word of ["", ...words]) html("option", { value: word }, select, word || "default");
      select.value = shown(now);
      select.addEventListener("change", () => send(select.value));
    } else if (entry === "lines") {
      const area = html("textarea", { rows: 4, spellcheck: "false", "data-entry": name }, label);
      area.value = shown(now);
      area.addEventListener("change", () => send(area.value.split("\n").filter((line) => line.trim())));
    } else {
      const input = html("input", { type: "text", autocomplete: "off", spellcheck: "false", "data-entry": name }, label);
      input.value = shown(now);
      input.addEventListener("change", () => send(entry === "numbers" ? [input.value].filter((text) => text.trim()) : input.value.trim()));
    }
  }
}

const shown = (entry: Entry): string => (entry === undefined ? "" : [entry].flat().join("\n"));
