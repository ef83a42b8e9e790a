// The numbers and wishes of a task as fields, and its text.

import { fill } from "../live/fields";
import type { LiveRequest, PositionShown, TaskState } from "../messages";
import { shortNumber, trimmed } from "../numbers";
import { html, say } from "../svg";
import type { Thing } from "./handles";

type Ask = (request: LiveRequest) => void;

const KINDS: Readonly<Record<string, string>> = { motion: "Poses of a body", path: "Points of a path", mixed: "Points and poses", function: "A function", improve: "Improve a mechanism" };
const MECHANISMS: Readonly<Record<string, string>> = {
  "": "all kinds of mechanisms",
  "four-bar": "four-bars",
  "slider-crank": "slider-cranks",
  "inverted-slider-crank": "inverted slider-cranks",
  "double-slider": "double sliders",
  "rapson-slide": "Rapson slides",
  "oldham-coupling": "Oldham couplings",
  "watt-ii": "Watt-II six-bars, of functions",
  given: "as in the text",
};

/** Entries that are one number or text: key, label, unit. */
const WISHES = [
  ["wanted.transmission.least", "Transmission angle at least", "angle"],
  ["wanted.lengths.least", "Links not shorter than", "length"],
  ["wanted.lengths.most", "Links not longer than", "length"],
  ["wanted.lengths.ratio", "Longest over shortest link at most", ""],
] as const;
const FUNCTION = [
  ["function.of", "Function of x", ""],
  ["function.x.0", "x from", ""],
  ["function.x.1", "x to", ""],
  ["function.input.0", "Crank from", "angle"],
  ["function.input.1", "Crank to", "angle"],
  ["function.output.0", "Output from", ""],
  ["function.output.1", "Output to", ""],
] as const;

const IMPROVE = [
  ["mechanism", "Mechanism: of the library, or a file", ""],
  ["improve.point", "Point that follows the positions", ""],
  ["improve.starts", "Starts", ""],
] as const;
/** Entries that are no numbers. */
const TEXTS: readonly string[] = ["function.of", "mechanism", "improve.point"];

export class TaskForm {
  readonly element = html("div", { class: "lw-t-form" });
  private readonly kind = this.choice("Task", KINDS, (value) => this.set("task", value));
  private readonly mechanism = this.choice("Find", MECHANISMS, (value) => value !== "given" && this.set("mechanism", value || null));
  private readonly positions = html("table", { class: "lw-t-positions" }, this.element);
  private readonly functions = html("div", { class: "lw-t-fields" }, this.element);
  private readonly fit = this.choice("Fit", { "": "exact at precision points", "least squares": "least squares", minimax: "minimax" }, (value) => this.set("function.fit", value || null));
  private readonly improved = html("div", { class: "lw-t-fields" }, this.element);
  private readonly goals = html("ul", { class: "lw-t-goals", "aria-label": "Goals" });
  private readonly order = this.choice("Order of positions", { "as given": "as given", any: "any" }, (value) => this.set("wanted.order", value));
  private readonly range = this.choice("Driven range", { "": "first to last position", "turns fully": "turns fully", given: "as in the text" }, (value) => value !== "given" && this.set("wanted.input", value || null));
  private readonly wishes = html("div", { class: "lw-t-fields" }, this.element);
  private readonly extra = html("p", { class: "lw-lead" }, this.element);
  private readonly text: HTMLTextAreaElement;
  private readonly fields = new Map<string, { input: HTMLInputElement; unit: HTMLElement; kind: string; wrong: HTMLElement }>();
  private rows = "";

  constructor(
    private readonly ask: Ask,
    private readonly pick: (thing: Thing) => void,
  ) {
    for (const [key, label, kind] of FUNCTION) this.field(this.functions, key, label, kind);
    for (const [key, label, kind] of IMPROVE) this.field(this.improved, key, label, kind);
    this.improved.before(this.goals);
    for (const [key, label, kind] of WISHES) this.field(this.wishes, key, label, kind);
    const box = html("details", { class: "lw-group" }, this.element);
    html("summary", {}, box, "Text of the task");
    this.text = html("textarea", { rows: 18, spellcheck: "false", "aria-label": "Text of the task" }, box);
    const apply = html("button", { type: "button" }, box, "Use this text");
    apply.addEventListener("click", () => this.ask({ kind: "set_text", text: this.text.value }));
  }

  show(task: TaskState): void {
    const { entries } = task;
    this.kind.value = task.task;
    const kinds = String(entries.mechanism ?? "");
    const several = !(kinds in MECHANISMS);
    this.mechanism.value = several ? "given" : kinds;
    (this.mechanism.querySelector("[value=given]") as HTMLOptionElement).hidden = !several;
    this.order.value = String(entries["wanted.order"] ?? "as given");
    const ranged = "wanted.input.from" in entries;
    this.range.options[0]!.textContent = task.task === "improve" ? "table of the mechanism" : "first to last position";
    this.range.value = ranged ? "given" : String(entries["wanted.input"] ?? "");
    (this.range.querySelector("[value=given]") as HTMLOptionElement).hidden = !ranged;
    const functions = task.task === "function";
    this.functions.hidden = this.fit.parentElement!.hidden = !functions;
    this.fit.value = String(entries["function.fit"] ?? "");
    this.order.parentElement!.hidden = functions;
    this.positions.hidden = functions && "function.of" in entries;
    this.mechanism.parentElement!.hidden = ["path", "mixed", "improve"].includes(task.task);
    this.improved.hidden = task.task !== "improve";
    this.goals.replaceChildren(...goalsOf(task).map((goal) => html("li", {}, undefined, goal)));
    for (const [key, { input, unit, kind, wrong }] of this.fields) {
      const value = entries[key];
      input.parentElement!.hidden = pairsOf(task) > 0 && /^function\.(of|x)/.test(key);
      fill(input, value === undefined ? "" : typeof value === "number" ? plain(value) : value);
      const problem = problemOf(task, key);
      input.setAttribute("aria-invalid", String(problem !== ""));
      say(wrong, problem);
      say(unit, kind === "angle" ? (task.angle_unit === "deg" ? "°" : "rad") : kind === "length" ? task.length_unit : "");
    }
    const pivots = task.fixed_pivots.length + task.moving_pivots.length;
    const parts = [pivots && `${pivots} fixed ${pivots === 1 ? "pivot" : "pivots"}`, task.region.length && "a region of fixed pivots", task.obstacles.length && `${task.obstacles.length} obstacle${task.obstacles.length === 1 ? "" : "s"}`].filter(Boolean);
    say(this.extra, parts.length ? `Drawn besides: ${parts.join(", ")}. Pick one on the canvas and press Delete to remove it.` : "");
    if (this.text !== document.activeElement) this.text.value = task.text;
    this.table(task);
  }

  /** Mark the row of the picked position. */
  mark(thing: Thing | null): void {
    for (const row of this.positions.querySelectorAll<HTMLElement>("tr[data-index]")) row.classList.toggle("lw-t-picked", thing?.of === "position" && Number(row.dataset.index) === thing.index);
  }

  private set(key: string, value: number | string | null): void {
    this.ask({ kind: "set_task_entry", key, value });
  }

  private choice(label: string, options: Readonly<Record<string, string>>, chosen: (value: string) => void): HTMLSelectElement {
    const holder = html("label", { class: "lw-t-choice" }, this.element, label);
    const select = html("select", {}, holder);
    for (const [value, text] of Object.entries(options)) html("option", { value }, select, text);
    select.addEventListener("change", () => chosen(select.value));
    return select;
  }

  private field(parent: Element, key: string, label: string, kind: string): void {
    const holder = html("label", { class: "lw-t-field" }, parent, label);
    const input = html("input", { type: "text", class: "lw-field", spellcheck: "false", "data-key": key, ...(TEXTS.includes(key) ? {} : { inputmode: "decimal" }) }, holder);
    const unit = html("span", { class: "lw-unit" }, holder);
    input.addEventListener("change", () => this.set(key, TEXTS.includes(key) ? input.value.trim() || null : number(input.value)));
    this.fields.set(key, { input, unit, kind, wrong: html("span", { class: "lw-t-wrong" }, holder) });
  }

  /** Positions, or pairs of a function, as rows of fields; kept while their number stays, so that the focus does. */
  private table(task: TaskState): void {
    const functions = task.task === "function";
    const posed = task.task === "motion" || task.positions.some(({ angle }) => angle !== null);
    const names: readonly Column[] = functions ? ["input", "output"] : posed ? ["x", "y", "tolerance", "angle", "angle_tolerance"] : ["x", "y", "tolerance"];
    // a row of pairs more, for another one
    const count = functions ? pairsOf(task) + 1 : task.positions.length;
    const made = `${count} ${names.join(" ")} ${task.length_unit} ${task.angle_unit} ${task.entries.mechanism} ${task.positions_from_file}`;
    if (made !== this.rows) this.tableAnew(task, names, count);
    this.rows = made;
    for (let k = 0; k < count; k++)
      for (const name of names) {
        const value = functions ? task.entries[keyOf(name, k)] : (task.positions[k]![name as keyof PositionShown] ?? "");
        const input = this.positions.querySelector<HTMLInputElement>(`tr[data-index="${k}"] input[data-name=${name}]`);
        input?.setAttribute("aria-invalid", String(problemOf(task, keyOf(name, k)) !== ""));
        if (input) fill(input, typeof value === "number" && !(name.endsWith("tolerance") && value === 0) ? plain(value) : "");
      }
  }

  private tableAnew(task: TaskState, names: readonly Column[], count: number): void {
    this.positions.replaceChildren();
    const head = html("tr", {}, html("thead", {}, this.positions));
    html("td", {}, head);
    for (const name of names) html("th", { scope: "col" }, head, `${name.endsWith("tolerance") ? "±" : name}${unitOf(name, task)}`);
    html("td", {}, head);
    const body = html("tbody", {}, this.positions);
    for (let k = 0; k < count; k++) this.row(body, k, names, task, k === count - 1);
  }

  private row(body: Element, index: number, names: readonly Column[], task: TaskState, last: boolean): void {
    const functions = names[0] === "input";
    const what = `${functions ? "pair" : "position"} ${index + 1}`;
    const fixed = task.positions_from_file;
    const row = html("tr", { "data-index": index }, body);
    html("th", { scope: "row" }, row, functions && last ? "+" : String(index + 1));
    for (const name of names) {
      const input = html("input", { type: "text", class: "lw-field", inputmode: "decimal", "data-name": name, "aria-label": `${name.replace("_", " ")} of ${what}` }, html("td", {}, row));
      input.disabled = fixed;
      if (!functions) input.addEventListener("focus", () => this.pick({ of: "position", index, knob: false }));
      input.addEventListener("change", () => this.set(keyOf(name, index), number(input.value)));
    }
    const cell = html("td", {}, row);
    if (fixed || (functions && last)) return;
    const gone = html("button", { type: "button", class: "lw-close", "aria-label": `Remove ${what}` }, cell, "×");
    gone.addEventListener("click", () => (functions ? this.set(keyOf("input", index), null) : this.ask({ kind: "remove_task_point", of: "position", index })));
  }
}

type Column = "x" | "y" | "tolerance" | "angle" | "angle_tolerance" | "input" | "output";
const PLACES: Readonly<Partial<Record<Column, number>>> = { x: 0, y: 1, input: 0, output: 1 };

/** The key of a number in a row of the table. */
function keyOf(name: Column, index: number): string {
  if (name === "input" || name === "output") return `function.pairs.${index}.${PLACES[name]}`;
  return `positions.${index}.${name in PLACES ? `point.${PLACES[name]}` : name}`;
}

/** What is wrong with an entry, "" if nothing is: a list of it is named `[1]` in a problem. */
export function problemOf({ problems }: Pick<TaskState, "problems">, key: string): string {
  const named = key.replace(/\.(\d+)(?=\.|$)/g, (_, index) => `[${Number(index) + 1}]`);
  return problems.find((problem) => problem.key === named)?.message ?? "";
}

/** How many pairs a function has. */
function pairsOf({ entries }: Pick<TaskState, "entries">): number {
  let count = 0;
  while (keyOf("input", count) in entries) count++;
  return count;
}

function unitOf(name: Column, task: TaskState): string {
  const angles = name.startsWith("angle") || name === "input" || (name === "output" && task.entries.mechanism !== "slider-crank");
  return ` [${angles ? (task.angle_unit === "deg" ? "°" : "rad") : task.length_unit}]`;
}

/** The goals of an improvement in words, and what varies. */
export function goalsOf({ entries }: Pick<TaskState, "entries">): string[] {
  const goals = new Map<string, Record<string, string>>();
  for (const [key, value] of Object.entries(entries)) {
    const found = /^improve\.goals\.(\d+)\.(\w+)(?:\.\d+)?$/.exec(key);
    if (!found) continue;
    const goal = goals.get(found[1]!) ?? {};
    const [name, text] = [found[2]!, typeof value === "number" ? plain(value) : value];
    goal[name] = name in goal ? `${goal[name]}, ${text}` : text;
    goals.set(found[1]!, goal);
  }
  const words = { target: "=", least: "≥", most: "≤", values: "=", at: "at", weight: "· weight" } as const;
  const lines = [...goals.values()].map((goal) => [goal.of ?? "?", ...Object.entries(words).flatMap(([name, word]) => (goal[name] === undefined ? [] : [`${word} ${goal[name]}`]))].join(" "));
  const varied = entries["improve.vary"];
  return [...lines.map((line) => `Goal: ${line}`), varied === undefined ? "" : `Varied: ${varied}`].filter(Boolean);
}

/** What is typed: a number with comma or point, nothing, or a text that the reader refuses with its reason. */
function number(text: string): number | string | null {
  const plainText = text.trim().replace(",", ".").replace("−", "-");
  if (!plainText) return null;
  return Number.isFinite(Number(plainText)) ? Number(plainText) : text;
}

/** A number as it is typed. */
function plain(value: number): string {
  return trimmed(shortNumber(value, 8)).replace("−", "-").replace(/^(.*)·10.*$/, () => String(value));
}
