// What can be done with the whole selection: its name, duplicates, mirror images.

import type { FileState, LiveEdit } from "../../messages";
import { html } from "../../svg";
import type { Desk } from "../asking";
import { centreOf, duplicate, mirror, mirrored, selectionOf, type Line, type Selection } from "./copies";
import type { Place, Places } from "./geometry";

export interface Chosen {
  readonly kind: "point" | "link" | "part";
  readonly name: string;
}

/** The state of the editor that these need. */
export interface Held {
  readonly chosen: Chosen | null;
  readonly selected: ReadonlySet<string>;
  readonly points: Places;
  /** A step of the grid. */
  readonly step: number;
  /** Select what will be in the next state of the file. */
  readonly expect: (wanted: Expected) => void;
}

/** A point or link, or several points. */
export interface Expected {
  readonly chosen: Chosen | null;
  readonly points: readonly string[];
}

export class Selected {
  constructor(
    private readonly desk: Desk,
    private readonly held: () => Held,
  ) {}

  /** Add the fields and buttons to the panel of the selection. */
  fill(panel: HTMLElement): void {
    const { chosen } = this.held();
    const file = this.desk.file();
    const weld = chosen?.kind === "part" && file.part_entries.some(({ table, name }) => table === "welds" && name === chosen.name);
    if (chosen && chosen.name !== "ground" && !weld) this.name(panel, chosen);
    if (!this.selection(file)) return;
    const box = html("div", { class: "lw-inspected-actions lw-copies" }, panel);
    const button = (label: string, title: string, act: () => void): void => {
      html("button", { type: "button", title }, box, label).addEventListener("click", act);
    };
    button("Duplicate", "A copy of the selection beside it (Ctrl+D)", () => this.duplicate());
    const about = html("select", { "aria-label": "Mirror about" }, box);
    const lines: [string, string][] = [["vertical", "left and right"], ["horizontal", "up and down"]];
    for (const { name, points } of file.links) if (points.length > 1) lines.push([`link ${name}`, `about ${name}`]);
    for (const [value, text] of lines) html("option", { value }, about, text);
    button("Mirror", "Mirror the selection", () => this.mirror(about.value, false));
    button("Mirror a copy", "A mirrored copy; pins on the line are shared", () => this.mirror(about.value, true));
  }

  /** A copy beside the selection. */
  duplicate(): void {
    const { points, step } = this.held();
    const file = this.desk.file();
    const chosen = this.selection(file);
    if (chosen) this.send(duplicate(file, points, chosen, ([x, y]) => [x + 10 * step, y - 10 * step]));
  }

  private mirror(about: string, copied: boolean): void {
    const { points } = this.held();
    const file = this.desk.file();
    const chosen = this.selection(file);
    if (!chosen) return;
    const line = this.line(about, chosen, file, points);
    if (copied) this.send(duplicate(file, points, chosen, (at) => mirrored(at, line), true));
    else this.desk.ask(mirror(points, chosen, line));
  }

  private line(about: string, chosen: Selection, file: FileState, points: Places): Line {
    const link = file.links.find(({ name }) => about === `link ${name}`);
    const [a, b] = (link?.points ?? []).map((name) => points[name]!) as [Place?, Place?];
    if (a && b) return { at: a, along: [b[0] - a[0], b[1] - a[1]] };
    return { at: centreOf(chosen.points.map((name) => points[name]!)), along: about === "vertical" ? [0, 1] : [1, 0] };
  }

  /** Send a copy, which is then selected. */
  private send(edit: LiveEdit): void {
    this.desk.ask(edit);
    if (edit.kind !== "duplicate") return;
    const { chosen, selected, expect } = this.held();
    const points = [...selected].map((name) => edit.names[name] ?? name);
    expect({ chosen: chosen && { kind: chosen.kind, name: edit.names[chosen.name] ?? chosen.name }, points });
  }

  private selection(file: FileState): Selection | null {
    const { chosen, selected } = this.held();
    const placed = new Set([...selected].filter((name) => name in file.points));
    if (!placed.size || (chosen && !["point", "link"].includes(chosen.kind)) || chosen?.name === "ground") return null;
    return selectionOf(file, placed, chosen?.kind === "link" ? chosen.name : undefined);
  }

  /** The name in the head of the panel, to be typed. */
  private name(panel: HTMLElement, { kind, name }: Chosen): void {
    const head = panel.querySelector("header strong");
    if (!head || name.includes(" ")) return; // a weld is named by its links
    head.textContent = head.textContent!.slice(0, -name.length).trim();
    const field = html("input", { type: "text", class: "lw-name-field", "aria-label": `Name of the ${kind}`, autocomplete: "off", spellcheck: "false" });
    field.value = name;
    head.after(field);
    field.addEventListener("change", () => {
      const wanted = field.value.trim();
      if (!wanted || wanted === name) {
        field.value = name;
        return;
      }
      const { points, links, parts } = this.desk.file();
      const taken = wanted in points || parts.includes(wanted) || links.some((link) => link.name === wanted);
      this.desk.ask({ kind: "rename", of: kind, name, new: wanted });
      field.blur();
      if (!taken) this.held().expect({ chosen: { kind, name: wanted }, points: [wanted] });
    });
  }
}
