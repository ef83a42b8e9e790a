// Notices next to the drawing: limits of the motion, problems, and decisions.

import type { FileChanged, FileOpened, LimitFound, MotionFound, ProblemsFound } from "../messages";
import { html } from "../svg";

/** Maximum number of listed dead points. */
const TOLD = 4;

/** Message of a complete cycle, which is not shown. */
const FOUND = "position found";

export type Choices = Readonly<Record<string, () => void>>;

export class Notices {
  readonly element = html("div", { class: "lw-notices" });
  private readonly motion = html("div", { class: "lw-motion-notice", role: "status" }, this.element);
  private readonly message = html("div", { class: "lw-message", role: "alert" }, this.element);

  /** The dead points of a motion, each with a button that moves to it. */
  limits(found: MotionFound, unit: string, goTo: (input: number) => void): void {
    const text = reach(found);
    if (!text && this.motion.hidden) return;
    this.motion.replaceChildren();
    this.motion.hidden = !text;
    this.motion.dataset.limits = String(found.limits.length);
    if (!text) return;
    html("span", {}, this.motion, text);
    for (const limit of found.limits.slice(0, TOLD)) {
      const button = html("button", { type: "button", class: "lw-limit-button" }, this.motion, told(limit, unit));
      button.title = limit.sentence;
      button.addEventListener("click", () => goTo(limit.input));
    }
    if (found.limits.length > TOLD) html("span", {}, this.motion, `and ${found.limits.length - TOLD} more`);
  }

  /** A mechanism that cannot be closed. */
  open(text: string, remedies: readonly (readonly [string, string, () => void])[]): void {
    this.motion.replaceChildren();
    this.motion.hidden = false;
    html("span", { class: "lw-open" }, this.motion, text);
    for (const [label, title, set] of remedies) {
      const button = html("button", { type: "button" }, this.motion, label);
      button.title = title;
      button.addEventListener("click", set);
    }
  }

  /** No statement about the motion. */
  calm(): void {
    this.motion.replaceChildren();
    this.motion.hidden = true;
  }

  /** Problems of the present file, or of `another` one that was not opened. */
  problems(found: ProblemsFound, another: string): void {
    this.clear();
    const several = found.problems.length > 1;
    const unchanged = several ? `${found.problems.length} problems; nothing was changed.` : "Not changed:";
    html("strong", {}, this.message, another ? `${another} is not opened; everything stays as it was:` : unchanged);
    const list = html("ul", {}, this.message);
    for (const problem of found.problems) {
      const entry = html("li", {}, list);
      const where = [problem.line === null ? "" : `line ${problem.line}`, problem.key].filter(Boolean).join(", ");
      if (where) html("code", {}, entry, where);
      entry.append(` ${problem.message}`);
    }
    this.closable();
  }

  /** A file of the visitor was opened: what was carried over of it, and what was not. */
  opened(event: FileOpened): void {
    if (!event.format) {
      this.done(`Opened ${event.source}.`);
      return;
    }
    const carried = Object.entries(event.carried).map(([what, count]) => `${count} ${count === 1 ? what.replace(/s$/, "") : what}`);
    const notes = [...Object.entries(event.renamed).map(([old, name]) => `renamed: ${old} is now ${name}`), ...event.left_out.map((what) => `not carried over: ${what}`)];
    this.done(`Imported ${event.source} (${event.format}): ${carried.join(", ")}.${notes.length ? "" : " Everything was carried over."}`);
    if (!notes.length) return;
    const list = html("ul", { tabindex: 0, "aria-label": "What was not carried over" }, this.message);
    for (const note of notes) html("li", {}, list, note);
  }

  changed(event: FileChanged, choices: Choices): void {
    this.say(event.message, event.reloaded || !event.unsaved ? {} : choices);
  }

  /** Confirm an action. */
  done(text: string): void {
    this.say(text);
    this.message.dataset.done = "";
  }

  say(text: string, choices: Choices = {}, lasting = true): void {
    this.clear();
    html("span", {}, this.message, text);
    for (const [label, act] of Object.entries(choices)) {
      const button = html("button", { type: "button" }, this.message, label);
      button.addEventListener("click", () => {
        this.clear();
        act();
      });
    }
    if (lasting) this.closable();
  }

  /** The message in words. */
  get text(): string {
    return [...this.message.children].flatMap((part) => (part.matches("button") ? [] : [part.textContent])).join(" ");
  }

  clear(): void {
    delete this.message.dataset.done;
    this.message.replaceChildren();
  }

  private closable(): void {
    const close = html("button", { type: "button", class: "lw-close", "aria-label": "Close this message" }, this.message, "×");
    close.addEventListener("click", () => this.clear());
  }
}

/** The unreached part of the range in words; empty if all of it is reached. */
export function reach(found: Pick<MotionFound, "limits" | "missing" | "message">): string {
  if (!found.limits.length && !found.missing) return found.message === FOUND ? "" : found.message;
  const missing = found.missing === 1 ? "1 position" : `${found.missing} positions`;
  if (!found.limits.length) return `${missing} of the range cannot be reached.`;
  const kind = found.limits.every((limit) => limit.what === "dead point") ? "Dead point" : "Limit";
  const head = `${kind}${found.limits.length > 1 ? "s" : ""}`;
  return found.missing ? `${missing} cannot be reached. ${head}:` : `${head}:`;
}

/** The input value of a limit. */
export function told(limit: LimitFound, unit: string): string {
  const value = String(Number(limit.input.toFixed(4))).replace("-", "\u2212");
  return `${limit.located ? "" : "about "}${value}${unit === "deg" ? "°" : unit ? ` ${unit}` : ""}`;
}
