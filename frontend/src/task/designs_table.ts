// All designs in a table that sorts; refused ones are grey, with their reason.

import type { DesignShown, DesignsSuggested, TaskSolved, TaskState } from "../messages";
import { measured, roundedDown, shortNumber, trimmed } from "../numbers";
import { html, say } from "../svg";
import { toggle } from "../controls";

/** Tasks whose positions are a path, and positions of a curve. */
export const PATHS: readonly string[] = ["path", "improve"];
const FEWEST = 5;

type Column = "number" | "mechanism" | "transmission" | "size" | "error" | "score";

const TITLES: Readonly<Record<Column, string>> = { number: "No.", mechanism: "Mechanism", transmission: "μ min", size: "Size", error: "Error", score: "Score" };
const ABOUT: Readonly<Record<Column, string>> = {
  number: "Rank among the sound designs, or place among the refused ones",
  mechanism: "Mechanism and driven link",
  transmission: "Smallest transmission angle over the driven range",
  size: "Longest link, or distance of the fixed pivots",
  error: "How far positions are missed",
  score: "Score of the ranking, 0 to 1",
};
const NAMES: Readonly<Record<string, string>> = { "inverted-slider-crank": "inverted slider-crank", "double-slider": "double slider", "rapson-slide": "Rapson slide", "oldham-coupling": "Oldham coupling", "watt-ii": "Watt II" };
/** Large values first when a column is chosen. */
const FALLING: readonly Column[] = ["transmission", "score"];

export class DesignsTable {
  readonly element = html("div", { class: "lw-t-designs" });
  private readonly lead = html("p", { class: "lw-lead", role: "status" }, this.element);
  private readonly nearest = html("button", { type: "button", class: "lw-t-nearest", hidden: "" }, this.element, "Nearest in the atlas");
  private readonly note = html("p", { class: "lw-lead" }, this.element);
  private readonly reasons = html("ul", { class: "lw-t-reasons" }, this.element);
  private readonly scroll = html("div", { class: "lw-t-scroll" }, this.element);
  private readonly table = html("table", {}, this.scroll);
  private readonly head = html("tr", {}, html("thead", {}, this.table));
  private readonly body = html("tbody", {}, this.table);
  private readonly more = html("p", { class: "lw-lead" }, this.element);
  private solved: TaskSolved | null = null;
  private suggested: readonly DesignShown[] = [];
  private task: TaskState | null = null;
  private by: Column | null = null;
  private falling = false;
  private refused = true;
  private chosen = -1;

  constructor(
    private readonly choose: (index: number) => void,
    findNearest: () => void,
  ) {
    this.nearest.addEventListener("click", findNearest);
    const box = html("div", { class: "lw-t-filter" });
    this.reasons.before(box);
    toggle(box, "Refused designs too", true, (on) => {
      this.refused = on;
      this.fill();
    });
    this.table.addEventListener("keydown", (event) => this.key(event));
  }

  /** Offer the atlas for paths; what it needs is said where it cannot be used. */
  offer(state: TaskState): void {
    const { task, positions } = (this.task = state);
    this.nearest.hidden = !PATHS.includes(task) || (task === "improve" && !positions.length);
    this.nearest.disabled = positions.length < FEWEST;
    this.nearest.title = this.nearest.disabled ? `A curve needs ${FEWEST} positions or more` : "Compare the positions with the paths of 38,000 mechanisms";
  }

  /** Designs that the search has not found; they head the list. */
  suggest(event: DesignsSuggested): void {
    this.suggested = event.designs;
    say(this.note, event.note);
    if (this.task) this.fill();
  }

  /** The list; null while there is none. */
  show(task: TaskState, solved: TaskSolved | null, why = ""): void {
    this.task = task;
    this.solved = solved;
    say(this.lead, solved ? verdict(solved, task.task) : why);
    this.reasons.replaceChildren();
    if (solved && !solved.sound) for (const [defect, count] of Object.entries(solved.defects)) html("li", {}, this.reasons, `${count} × ${defect}`);
    this.fill();
  }

  /** Mark the chosen design, and bring it into sight where the list scrolls by itself. */
  mark(index: number): void {
    this.chosen = index;
    const { scrollHeight, clientHeight } = this.element;
    for (const row of this.body.rows) {
      row.setAttribute("aria-selected", String(Number(row.dataset.index) === index));
      if (Number(row.dataset.index) === index && scrollHeight > clientHeight) row.scrollIntoView({ block: "nearest" });
    }
  }

  /** All designs, sound ones first: suggested ones, then those found. */
  get designs(): readonly DesignShown[] {
    return soundFirst([...this.suggested, ...(this.solved?.designs ?? [])]);
  }

  private get columns(): Column[] {
    const errors = this.designs.some(({ error }) => error);
    return ["number", "mechanism", "transmission", "size", ...(errors ? ["error" as const] : []), "score"];
  }

  private fill(): void {
    const { solved, task } = this;
    this.head.replaceChildren();
    this.body.replaceChildren();
    say(this.more, solved?.left_out ? `${solved.left_out} more designs are not listed; linkwork synthesize --csv writes all.` : "");
    const { designs } = this;
    this.element.classList.toggle("lw-t-none", !designs.length);
    if (!designs.length || !task) return;
    for (const column of this.columns) this.title(column, task, solved?.error_unit ?? task.length_unit);
    const shown = designs.filter(({ sound }) => sound || this.refused);
    for (const design of this.sorted(shown)) this.row(design);
    this.mark(this.chosen);
  }

  private title(column: Column, task: TaskState, errorUnit: string): void {
    const unit = { transmission: task.angle_unit === "deg" ? "°" : "rad", size: task.length_unit, error: errorUnit === "deg" ? "°" : errorUnit }[column as string];
    const sorted = this.by === column ? (this.falling ? "descending" : "ascending") : "none";
    const cell = html("th", { scope: "col", "aria-sort": sorted }, this.head);
    const button = html("button", { type: "button", title: ABOUT[column] }, cell, TITLES[column] + (unit ? ` [${unit}]` : ""));
    button.addEventListener("click", () => {
      this.falling = this.by === column ? !this.falling : FALLING.includes(column);
      this.by = column;
      this.fill();
      this.head.querySelectorAll<HTMLElement>("button")[this.columns.indexOf(column)]?.focus();
    });
  }

  private sorted(designs: readonly DesignShown[]): readonly DesignShown[] {
    const { by } = this;
    if (by === null) return designs;
    const sense = this.falling ? -1 : 1;
    const key = (one: DesignShown): number | string | null => (by === "mechanism" ? `${one.mechanism} ${one.drive}` : one[by]);
    return [...designs].sort((one, other) => {
      const [a, b] = [key(one), key(other)];
      if (a === null || b === null) return a === b ? 0 : a === null ? 1 : -1; // without a value last
      return sense * (typeof a === "string" ? a.localeCompare(String(b)) : a - (b as number));
    });
  }

  private row(design: DesignShown): void {
    const row = html("tr", { tabindex: 0, "data-index": design.index, class: design.sound ? "" : "lw-t-refused" }, this.body);
    row.addEventListener("click", () => this.choose(design.index));
    for (const column of this.columns) {
      if (column === "mechanism") {
        const cell = html("td", {}, row, `${inWords(design)}, ${design.drive}`);
        if (design.reason) html("span", { class: "lw-t-reason" }, cell, design.reason);
      } else html(column === "number" ? "th" : "td", column === "number" ? { scope: "row" } : {}, row, this.number(design, column));
    }
  }

  private number(design: DesignShown, column: Exclude<Column, "mechanism">): string {
    const value = design[column];
    if (value === null) return "–";
    if (design.origin && column === "number") return origin(design);
    if (column === "number") return design.sound ? String(value) : `(${value})`;
    return trimmed(shortNumber(column === "transmission" ? roundedDown(value, 4) : value, 4));
  }

  private key(event: KeyboardEvent): void {
    const row = (event.target as Element).closest<HTMLTableRowElement>("tbody tr");
    if (!row) return;
    const next = { ArrowDown: row.nextElementSibling, ArrowUp: row.previousElementSibling }[event.key];
    if (next === undefined && event.key !== "Enter") return;
    event.preventDefault();
    event.stopPropagation();
    const chosen = (next ?? row) as HTMLTableRowElement;
    chosen.focus();
    this.choose(Number(chosen.dataset.index));
  }
}

/** Designs in their order, the refused ones after the sound ones. */
export function soundFirst(designs: readonly DesignShown[]): readonly DesignShown[] {
  return [...designs.filter(({ sound }) => sound), ...designs.filter(({ sound }) => !sound)];
}

/** The counts in one sentence, or why there is no sound design. */
export function verdict(solved: TaskSolved, kind: string): string {
  const designs = `${solved.count} design${solved.count === 1 ? "" : "s"}`;
  const stopped = solved.interrupted ? "Stopped: the best so far. " : "";
  const none = kind === "improve" ? "No start leads to a design." : "No mechanism of the wanted kinds solves the task.";
  if (!solved.count) return stopped ? "Stopped before a design was found." : `${none} ${solved.advice}`.trim();
  if (solved.sound) return `${stopped}${designs}, ${solved.sound} without defects${solved.delivered < solved.sound ? `; the best ${solved.delivered} are delivered` : ""}.`;
  const cost = solved.most_restrictive ? `The requirement that rejects the most designs is ${solved.most_restrictive}: without it ${solved.costs} more would do. ${solved.advice}` : solved.advice;
  return `${stopped}No design is free of defects (${designs}). ${cost}`.trim();
}

/** A design in one line. */
export function inOneLine(design: DesignShown, task: TaskState): string {
  const driven = design.drive.startsWith("slider") ? `driven at the ${design.drive}` : `driven at ${design.drive}`;
  const angle = design.transmission === null ? "" : `, transmission angle ≥ ${measured(roundedDown(design.transmission, 4), task.angle_unit)}`;
  const size = design.size === null ? "" : `, longest link ${`${trimmed(shortNumber(design.size, 4))} ${task.length_unit}`}`;
  return `${inWords(design)} ${driven}${angle}${size}`;
}

/** What a design is called. */
export function called(design: DesignShown): string {
  if (design.origin === "as given") return "The mechanism as given";
  const name = design.origin === "atlas" ? `Atlas ${design.number}` : design.origin ? `Improved ${design.number}` : `Design ${design.number}`;
  return design.sound || design.origin ? name : "Refused";
}

function origin({ origin: from, number }: DesignShown): string {
  return from === "as given" ? "given" : `${from === "atlas" ? "A" : "I"}${number}`;
}

function inWords({ mechanism }: DesignShown): string {
  const known = NAMES[mechanism] ?? mechanism;
  return known.replace(/ with a .*$/, ""); // the point is that of the task
}
