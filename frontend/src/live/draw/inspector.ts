// The panel at the selected point or link: its numbers, and what can be done with it.

import type { FileState, LiveEdit, PartShown } from "../../messages";
import { shortNumber, trimmed } from "../../numbers";
import { html } from "../../svg";
import type { Desk } from "../asking";
import { fill } from "../fields";
import { rebuilt, type ForceForms } from "../force_forms";
import { typed } from "../ranges";
import { PartPanel } from "./part_panel";
import type { Chosen } from "./selected";
import { partsOf } from "./symbols";
import { driving } from "./tool_edits";

interface Action {
  readonly label: string;
  readonly edits: readonly LiveEdit[];
  /** Why it is not possible. */
  readonly reason?: string;
}

export class Inspector {
  readonly element = html("section", { class: "lw-inspector", "aria-label": "Selection", hidden: "" });
  readonly parts: PartPanel;
  private readonly locks = new Set<string>();
  /** Adds what concerns every selection. */
  more: (panel: HTMLElement) => void = () => {};

  constructor(
    private readonly desk: Desk,
    private readonly forms: ForceForms,
    private readonly closed: () => void,
    private readonly goTo: (chosen: Chosen) => void,
  ) {
    this.parts = new PartPanel(desk, (name) => goTo({ kind: "link", name }));
    this.element.addEventListener("pointerdown", (event) => event.stopPropagation());
  }

  /** Lengths that stay when points are dragged. */
  get locked(): string[] {
    return [...this.locks];
  }

  show(chosen: Chosen | null, file: FileState): void {
    this.element.hidden = chosen === null;
    if (chosen === null) return;
    // a field keeps what is being typed
    if (this.element.contains(document.activeElement) && document.activeElement instanceof HTMLInputElement && this.element.dataset.of === `${chosen.kind} ${chosen.name}`) {
      this.refresh(file);
      return;
    }
    this.element.dataset.of = `${chosen.kind} ${chosen.name}`;
    const part = chosen.kind === "part" ? partNamed(chosen.name, file) : undefined;
    this.begin(part ? this.parts.title(part) : chosen.kind === "point" ? `Point ${chosen.name}` : `Link ${chosen.name}`);
    if (chosen.kind === "point") this.point(chosen.name, file);
    else if (chosen.kind === "link") this.link(chosen.name, file);
    else if (part) this.part(part, file);
    this.forms.at(this.element, chosen.kind, chosen.name, file);
    this.more(this.element);
  }

  private part(part: PartShown, file: FileState): void {
    this.parts.show(this.element, part);
    this.actions(this.parts.actions(part, file));
  }

  showMany(names: readonly string[], file: FileState): void {
    if (names.length < 2) {
      this.show(names.length ? { kind: "point", name: names[0]! } : null, file);
      return;
    }
    this.element.hidden = false;
    this.element.dataset.of = "several";
    this.begin(`${names.length} points: ${names.join(", ")}`);
    this.actions([
      { label: "Fix to ground", edits: [{ kind: "set_ground", points: names }] },
      { label: "Delete", edits: names.map((name) => ({ kind: "remove_point", name })) },
    ]);
    this.more(this.element);
  }

  private begin(title: string): void {
    this.element.replaceChildren();
    const head = html("header", {}, this.element);
    html("strong", {}, head, title);
    const close = html("button", { type: "button", class: "lw-close", "aria-label": "Close" }, head, "×");
    close.addEventListener("click", () => this.closed());
  }

  private point(name: string, file: FileState): void {
    this.numbers([`${name}.x`, `${name}.y`, ...this.lengthsAt(name, file)], file);
    const fixed = file.links.some((link) => link.name === "ground" && link.points.includes(name));
    const traced = file.traced.includes(name);
    this.actions([
      { label: fixed ? "Release from ground" : "Fix to ground", edits: [{ kind: "set_ground", points: [name], on: !fixed }] },
      { label: traced ? "Hide path" : "Show path", edits: [{ kind: "trace_point", point: name, on: !traced }], ...(fixed ? { reason: "a fixed point has no path" } : {}) },
      { label: "Delete", edits: [{ kind: "remove_point", name }] },
    ]);
  }

  private link(name: string, file: FileState): void {
    const own = file.links.find((link) => link.name === name)!;
    const pairs = own.points.slice(1).map((point, k) => `${own.points[k]} ${point}`);
    if (own.points.length > 2) pairs.push(`${own.points[own.points.length - 1]} ${own.points[0]}`);
    this.numbers(pairs, file);
    if (own.points.length > 1) html("p", { class: "lw-lead" }, this.element, `Its angle is the direction from ${own.points[0]} to ${own.points[1]}.`);
    const driven = file.inputs.some((input) => input.name === name);
    const drivable = file.drives.some((drive) => drive.name === name);
    const reason = driven ? "it is driven already" : drivable ? "" : "only moving links can be driven";
    this.actions([
      { label: "Drive", edits: [driving(file, "link", name)], ...(reason ? { reason } : {}) },
      { label: "Turn direction", edits: [{ kind: "reverse_link", name }], ...(own.points.length < 2 ? { reason: "a link of one point has no direction" } : {}) },
      { label: "Delete", edits: [{ kind: "remove_link", name }] },
    ]);
    const box = html("div", { class: "lw-inspected-actions" }, this.element);
    for (const part of partsOf(name, file)) {
      const button = html("button", { type: "button" }, box, this.parts.title(part));
      button.addEventListener("click", () => this.goTo({ kind: "part", name: part.name }));
    }
  }

  /** The lengths from a point to its neighbours. */
  private lengthsAt(name: string, file: FileState): string[] {
    const found = file.numbers.filter(({ table, name: key }) => ["lengths", "measured"].includes(table) && key.split(" ").includes(name));
    return found.map((number) => number.name).slice(0, 6);
  }

  private numbers(names: readonly string[], file: FileState): void {
    for (const name of names) {
      const number = find(file, name);
      if (!number) continue;
      const row = html("div", { class: "lw-inspected" }, this.element);
      const label = html("label", {}, row, name.endsWith(".x") ? "x" : name.endsWith(".y") ? "y" : name);
      const input = html("input", { type: "text", autocomplete: "off", spellcheck: "false", "data-number": number.name }, label);
      input.value = number.formula || trimmed(shortNumber(number.value, 6));
      html("span", { class: "lw-unit" }, row, number.unit);
      const send = (): void => {
        const value = typed(input.value);
        if (value !== number.value && input.value !== number.formula && value !== "") this.desk.ask({ kind: "set_number", name: number.name, value });
      };
      input.addEventListener("change", send);
      if (["lengths", "measured"].includes(number.table)) this.lock(row, number.name);
    }
  }

  private lock(row: Element, name: string): void {
    const label = html("label", { class: "lw-lock", title: `Keep ${name} while points are dragged` }, row);
    const box = html("input", { type: "checkbox", "aria-label": `Lock ${name}` }, label);
    box.checked = this.locks.has(name);
    label.append("lock");
    box.addEventListener("change", () => (box.checked ? this.locks.add(name) : this.locks.delete(name)));
  }

  /** Other values of the same numbers. */
  private refresh(file: FileState): void {
    const of = this.element.dataset.of!;
    const part = partNamed(of.replace(/^part /, ""), file);
    rebuilt(this.element, () => {
      const old = this.element.querySelector(".lw-forces-at");
      const [kind, name] = [of.slice(0, of.indexOf(" ")) as Chosen["kind"], of.slice(of.indexOf(" ") + 1)];
      this.forms.at(this.element, kind, name, file);
      const fresh = this.element.querySelector(".lw-forces-at:last-child");
      if (!old || !fresh || old === fresh) return;
      (fresh as HTMLDetailsElement).open = (old as HTMLDetailsElement).open;
      old.replaceWith(fresh);
    });
    if (part) this.parts.refresh(this.element, part);
    for (const input of this.element.querySelectorAll<HTMLInputElement>("input[data-number]")) {
      const number = find(file, input.dataset.number!);
      if (number) fill(input, number.formula || trimmed(shortNumber(number.value, 6)));
    }
  }

  private actions(actions: readonly Action[]): void {
    const box = html("div", { class: "lw-inspected-actions" }, this.element);
    for (const { label, edits, reason } of actions) {
      const button = html("button", { type: "button" }, box, label);
      button.disabled = reason !== undefined;
      if (reason) button.title = `Not possible: ${reason}`;
      button.addEventListener("click", () => this.desk.ask(edits.length === 1 ? edits[0]! : { kind: "together", edits }));
    }
  }
}

function find(file: FileState, name: string): FileState["numbers"][number] | undefined {
  const turned = name.split(" ").reverse().join(" ");
  return file.numbers.find((one) => one.name === name) ?? file.numbers.find((one) => one.name === turned);
}

function partNamed(name: string, file: FileState): PartShown | undefined {
  return file.part_entries.find((part) => part.name === name);
}
