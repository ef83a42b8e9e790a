// Questions about a mechanism: what would answer them is hidden until they are answered.

import { measured, trimmed } from "./numbers";
import type { AnswerData, MotionData, PageData, QuestionData } from "./page_data";
import { html, say } from "./svg";

const WORDS = ["numbers", "charts", "limits", "equations", "input"] as const;
export type Hidden = (typeof WORDS)[number];

/** Answers that say that there is none. */
const NONE = new Set(["none", "no", "never", "-", "–"]);

/** A typed number, with comma or point and any minus; NaN otherwise. */
function numberOf(text: string): number {
  const plain = text.trim().replace(/[−–]/g, "-").replace(",", ".").replace(/\s*(°|deg|rad|[a-z/]+)$/i, "");
  return plain ? Number(plain) : NaN;
}

/** Whether a typed text answers a question. */
export function right({ tolerance, turn }: Pick<QuestionData, "tolerance" | "turn">, { known, values }: AnswerData, typed: string): boolean {
  if (!known) return false;
  if (!values.length) return NONE.has(typed.trim().toLowerCase());
  const given = numberOf(typed);
  return values.some((value) => {
    const off = given - value;
    return Math.abs(turn ? off - turn * Math.round(off / turn) : off) <= tolerance * (1 + 1e-9);
  });
}

/** An answer in words. */
export function told({ unit }: Pick<QuestionData, "unit">, answer: AnswerData | undefined): string {
  if (!answer?.known) return "The answer is not known here: it was computed for the mechanism as it was, or there is no position.";
  if (!answer.values.length) return "There is none.";
  return answer.values.map((value) => measured(Number(trimmed(value.toPrecision(6))), unit)).join(" or ");
}

interface Entry {
  readonly box: HTMLElement;
  readonly note: HTMLElement;
  open: boolean;
}

export class Questions {
  readonly element = html("section", { class: "lw-questions", "aria-label": "Questions", hidden: "" });
  private entries: Entry[] = [];
  private asked: readonly QuestionData[] = [];
  private answers: readonly AnswerData[] = [];

  /** `root` has a class for all that is hidden; `changed` is called after that changes. */
  constructor(
    private readonly root: Element,
    private readonly changed: () => void,
  ) {}

  hides(what: Hidden): boolean {
    return this.asked.some((question, k) => !this.entries[k]!.open && question.hide.includes(what));
  }

  /** The questions of a page and the answers of one of its motions; `steady`: during a drag. */
  show({ questions }: PageData, motion: MotionData, steady: boolean): void {
    if (JSON.stringify(questions) !== JSON.stringify(this.asked)) this.make(questions);
    if (steady) return;
    this.answers = motion.answers;
    this.entries.forEach((entry, k) => entry.open && this.reveal(k, ""));
  }

  private make(questions: readonly QuestionData[]): void {
    const opened = new Set(this.asked.flatMap((question, k) => (this.entries[k]!.open ? [question.text] : [])));
    this.asked = questions;
    this.element.replaceChildren();
    this.element.hidden = !questions.length;
    this.entries = questions.map((question, k) => this.entry(question, k, opened.has(question.text)));
    this.hide();
  }

  private entry({ text, unit }: QuestionData, k: number, open: boolean): Entry {
    const box = html("form", { class: "lw-question", novalidate: "" }, this.element);
    const label = html("label", {}, box);
    html("span", {}, label, text);
    const field = html("input", { type: "text", inputmode: "decimal", autocomplete: "off", spellcheck: "false" }, label);
    html("span", { class: "lw-unit" }, box, unit === "deg" ? "°" : unit);
    html("button", { type: "submit" }, box, "Check");
    const show = html("button", { type: "button" }, box, "Show the answer");
    const note = html("p", { role: "status" }, box);
    box.addEventListener("submit", (event) => {
      event.preventDefault();
      this.check(k, field.value);
    });
    show.addEventListener("click", () => this.reveal(k, ""));
    return { box, note, open };
  }

  private check(k: number, typed: string): void {
    const answer = this.answers[k];
    const { note, open } = this.entries[k]!;
    const around = `within ${this.asked[k]!.tolerance} ${this.asked[k]!.unit}`.trim();
    if (!typed.trim()) say(note, "Type a number.");
    else if (!answer?.known) this.reveal(k, "");
    else if (right(this.asked[k]!, answer, typed)) this.reveal(k, "Right: ");
    else if (Number.isNaN(numberOf(typed)) && !NONE.has(typed.trim().toLowerCase())) say(note, "This is not a number.");
    else say(note, open ? `Not ${around}: ${told(this.asked[k]!, answer)}` : `Not ${around} of the answer. Try again, or have it shown.`);
  }

  private reveal(k: number, before: string): void {
    const entry = this.entries[k]!;
    say(entry.note, `${before}${told(this.asked[k]!, this.answers[k])}`);
    entry.box.classList.add("lw-answered");
    if (entry.open) return;
    entry.open = true;
    this.hide();
  }

  private hide(): void {
    for (const what of WORDS) this.root.classList.toggle(`lw-hides-${what}`, this.hides(what));
    this.changed();
  }
}
