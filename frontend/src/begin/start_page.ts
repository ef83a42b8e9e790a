// The start page: a blank sheet, templates, and the library with moving pictures.

import { html } from "../svg";
import { frameAt, searched, type Entry } from "./library";
import { Thumbnail } from "./thumbnail";

/** Mechanisms to begin with, and what they are called here. */
const TEMPLATES: Readonly<Record<string, string>> = {
  "four-bar": "Four-bar",
  "slider-crank": "Slider-crank",
  "crank-shaper": "Quick return",
  "coupled-six-link": "Six-bar",
  "planetary-gear": "Gears",
  "cam-roller-follower": "Cam",
};

/** Tasks to begin with: what they are called here, and what they are for. */
const TASKS: Readonly<Record<string, readonly [string, string]>> = {
  "three-poses": ["Three poses", "Carry a body; choose pivots freely."],
  "four-poses": ["Four poses", "Drag a pivot along its curve; the design follows."],
  "five-poses": ["Five poses", "All four-bars and slider-cranks, proved."],
  "nine-points": ["Nine points", "All four-bars whose point passes them."],
  curve: ["A curve", "Draw it; the nearest coupler curves are found."],
  function: ["A function", "The output follows a formula of the input."],
};

export interface StartHooks {
  /** Open a mechanism of the library, "" is the blank sheet, or a task. */
  readonly open: (name: string, of: "example" | "task") => void;
  /** Choose a file of the visitor; absent while there is no program to open it. */
  readonly file?: () => void;
  /** Leave the page as it is; absent where there is nothing to go back to. */
  readonly close?: () => void;
}

export class StartPage {
  readonly element = html("section", { class: "lw-start", "aria-label": "Begin" });
  private readonly message: HTMLElement;
  private readonly file: HTMLButtonElement;
  private own!: StartHooks;
  private readonly list: HTMLElement;
  private readonly count: HTMLElement;
  private readonly moving = new Map<Element, Thumbnail>();
  private readonly visible = new Set<Thumbnail>();
  private readonly seen: IntersectionObserver;
  private readonly calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  private frame = 0;

  constructor(
    private readonly entries: readonly Entry[],
    hooks: StartHooks,
  ) {
    this.seen = new IntersectionObserver((changes) => {
      for (const { target, isIntersecting } of changes) {
        const picture = this.moving.get(target);
        if (picture) this.visible[isIntersecting ? "add" : "delete"](picture);
      }
    });
    const head = html("header", {}, this.element);
    html("h1", {}, head, "Linkwork");
    html("p", {}, head, "Draw a mechanism, begin with one of the library, or design one for a task.");
    if (hooks.close) {
      const close = html("button", { type: "button" }, head, "Back");
      close.addEventListener("click", () => this.own.close?.());
    }
    this.message = html("p", { class: "lw-start-note", role: "alert", hidden: "" }, this.element);
    const first = html("div", { class: "lw-cards" }, this.element);
    this.blank(first);
    this.file = this.fileCard(first);
    this.hooks = hooks;
    for (const [name, title] of Object.entries(TEMPLATES)) {
      const entry = entries.find((one) => one.name === name);
      if (entry) this.card(first, { ...entry, title });
    }
    html("h2", {}, this.element, "Design for a task");
    const tasks = html("div", { class: "lw-cards lw-tasks" }, this.element);
    for (const [name, [title, purpose]] of Object.entries(TASKS)) this.task(tasks, name, title, purpose);
    const label = html("label", { class: "lw-search" }, this.element, "Find by name, family or purpose");
    const field = html("input", { type: "search", placeholder: "press, straight line, dwell, walking …", autocomplete: "off" }, label);
    field.addEventListener("input", () => this.find(field.value));
    this.count = html("p", { class: "lw-lead", role: "status" }, this.element);
    this.list = html("div", { class: "lw-families" }, this.element);
    this.find("");
    if (!this.calm) this.frame = requestAnimationFrame((now) => this.tick(now));
  }

  set hooks(hooks: StartHooks) {
    this.own = hooks;
    this.file.disabled = !hooks.file;
  }

  /** Why nothing was opened. */
  note(text: string): void {
    this.message.textContent = text;
    this.message.hidden = !text;
    this.element.scrollTop = 0;
  }

  destroy(): void {
    cancelAnimationFrame(this.frame);
    this.seen.disconnect();
    this.element.remove();
  }

  private find(search: string): void {
    for (const card of this.list.querySelectorAll(".lw-card svg")) this.forget(card);
    this.list.replaceChildren();
    const found = searched(this.entries, search);
    this.count.textContent = found.length ? `${found.length} mechanism${found.length > 1 ? "s" : ""}` : `Nothing is called or does "${search}": try a shorter word.`;
    if (search.trim()) {
      const box = html("div", { class: "lw-cards" }, this.list);
      for (const entry of found) this.card(box, entry);
      return;
    }
    const families = [...new Set(found.map((one) => one.family || "others"))].sort();
    for (const family of families) {
      html("h2", {}, this.list, `${family.slice(0, 1).toUpperCase()}${family.slice(1)}`);
      const box = html("div", { class: "lw-cards" }, this.list);
      for (const entry of found) if ((entry.family || "others") === family) this.card(box, entry);
    }
  }

  private forget(svg: Element): void {
    const picture = this.moving.get(svg);
    this.seen.unobserve(svg);
    this.moving.delete(svg);
    if (picture) this.visible.delete(picture);
  }

  private blank(box: Element): void {
    const card = html("button", { type: "button", class: "lw-card lw-blank" }, box);
    html("span", { class: "lw-plus", "aria-hidden": "true" }, card, "+");
    html("strong", {}, card, "Blank sheet");
    card.addEventListener("click", () => this.own.open("", "example"));
  }

  private fileCard(box: Element): HTMLButtonElement {
    const card = html("button", { type: "button", class: "lw-card lw-open-file" }, box);
    html("span", { class: "lw-plus", "aria-hidden": "true" }, card, "↥");
    html("strong", {}, card, "Open a file");
    html("span", {}, card, "Or drop it on the page: also of PMKS+, GeoGebra, DXF and others.");
    card.addEventListener("click", () => this.own.file?.());
    return card;
  }

  private task(box: Element, name: string, title: string, purpose: string): void {
    const card = html("button", { type: "button", class: "lw-card", "data-task": name }, box);
    html("strong", {}, card, title);
    html("span", {}, card, purpose);
    card.addEventListener("click", () => this.own.open(name, "task"));
  }

  private card(box: Element, { name, title, purpose, picture }: Entry): void {
    const card = html("button", { type: "button", class: "lw-card", "data-example": name, title: purpose }, box);
    if (picture) {
      const thumbnail = new Thumbnail(picture);
      this.moving.set(thumbnail.element, thumbnail);
      this.seen.observe(thumbnail.element);
      card.append(thumbnail.element);
    } else html("span", { class: "lw-formula-card", "aria-hidden": "true" }, card, "F(q) = 0");
    html("strong", {}, card, title);
    html("span", {}, card, purpose);
    card.addEventListener("click", () => this.own.open(name, "example"));
  }

  private tick(now: number): void {
    for (const thumbnail of this.visible) {
      const { frames, closed } = thumbnail.picture;
      thumbnail.show(frameAt(frames.length, closed, now / 1000));
    }
    this.frame = requestAnimationFrame((next) => this.tick(next));
  }
}
