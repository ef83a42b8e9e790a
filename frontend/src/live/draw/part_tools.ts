// Tools for parts: a button that opens them, each with a symbol and a key.

import type { PalettePart } from "../../messages";
import { html, svg } from "../../svg";

/** The short name, the key and the symbol, in a square of 24, of the tool of a table. */
const LOOKS: Readonly<Record<string, readonly [string, string, string]>> = {
  slots: ["Slot", "o", "M5 8.500h14a3.500 3.500 0 0 1 0 7h-14a3.500 3.500 0 0 1 0-7M9 12m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0"],
  cylinders: ["Cylinder", "c", "M3 9h10v6H3zM13 12h8M9 9v6M21 10v4"],
  welds: ["Weld", "w", "M4 19L12 6L20 19M12 6l-3.200 5.200h6.400z"],
  gears: ["Gears", "e", "M8 12m-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0M17 12m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0M8 5v2M8 17v2M3.100 7.100l1.400 1.400M3.100 16.900l1.400-1.400M17 6v2M17 16v2M21.500 7.500l-1.500 1.500M21.500 16.500l-1.500-1.500"],
  noncircular_gears: ["Ovals", "x", "M7.500 12m-5 0a5 3.200 0 1 0 10 0a5 3.200 0 1 0-10 0M16 12m-3.200 0a3.200 6 0 1 0 6.400 0a3.200 6 0 1 0-6.400 0"],
  belts: ["Belt", "b", "M7 7.500a4.500 4.500 0 1 0 0 9L18 14.800a2.800 2.800 0 0 0 0-5.600zM7 12m-1 0a1 1 0 1 0 2 0a1 1 0 1 0-2 0M18 12m-.8 0a.8 .8 0 1 0 1.600 0a.8 .8 0 1 0-1.600 0"],
  racks: ["Rack", "k", "M12 8.500m-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0M2 20V16h2.500l1-2h2l1 2h2.500l1-2h2l1 2h2.500l1-2h2l1 2V20z"],
  rolling: ["Rolling", "r", "M12 10m-7 0a7 7 0 1 0 14 0a7 7 0 1 0-14 0M3 17h18M12 10l4-4M6 20l-2 2M12 20l-2 2M18 20l-2 2"],
  cams: ["Cam", "a", "M12 3a5.500 5.500 0 0 1 4.500 8.500a6 6 0 1 1-9 0A5.500 5.500 0 0 1 12 3M12 15m-1.200 0a1.200 1.200 0 1 0 2.400 0a1.200 1.200 0 1 0-2.400 0"],
  curves: ["Curve", "u", "M3 17c3-12 7-12 9-5s6 5 9-4M12 12m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0"],
  loads: ["Load", "j", "M5 19L19 5M19 5h-6M19 5v6M5 19m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0"],
  springs: ["Spring", "n", "M2 12h3l1.500-5 3 10 3-10 3 10 3-10 1.500 5h2"],
};

/** The tools of parts by table, with their keys. */
export const PART_TOOLS = Object.entries(LOOKS).map(([name, [title, key]]) => ({ name, key, title }));

export class PartTools {
  /** Opens the tools; in the tool bar. */
  readonly opener = html("button", { type: "button", class: "lw-parts-opener", "aria-expanded": "false", "aria-pressed": "false", title: "Parts: slots, gears, cams and more" });
  /** The tools, beside the tool bar. */
  readonly element = html("div", { class: "lw-part-tools", role: "toolbar", "aria-label": "Parts", hidden: "" });
  /** What to pick next, on the drawing. */
  readonly prompt = html("p", { class: "lw-part-prompt", hidden: "" });
  private readonly buttons = new Map<string, HTMLButtonElement>();
  private parts: readonly PalettePart[] = [];
  private readonly icon: SVGPathElement;
  private readonly text: HTMLElement;

  constructor(private readonly chosen: (table: string) => void) {
    this.icon = svg("path", { d: LOOKS.gears![2] }, svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, this.opener));
    this.text = html("span", {}, this.opener, "Parts");
    this.opener.addEventListener("click", (event) => {
      this.open(this.element.hidden);
      if (!this.element.hidden && event.detail === 0) this.element.querySelector("button")?.focus();
    });
    this.element.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      this.open(false);
      this.opener.focus();
      event.stopPropagation();
    });
    document.addEventListener("pointerdown", ({ target }) => {
      if (!this.element.contains(target as Node) && !this.opener.contains(target as Node)) this.open(false);
    });
  }

  offer(parts: readonly PalettePart[]): void {
    this.parts = parts.filter(({ picks }) => picks.length > 0);
    this.element.replaceChildren();
    this.buttons.clear();
    for (const { table, title, doc } of this.parts) {
      const [name, key, icon] = LOOKS[table] ?? [title, "", ""];
      const letter = key.toUpperCase();
      const button = html("button", { type: "button", "aria-pressed": "false", title: `${title} (${letter}): ${doc}`, "aria-label": title, "aria-keyshortcuts": letter, "data-table": table }, this.element);
      svg("path", { d: icon }, svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, button));
      html("span", {}, button, name);
      html("kbd", { "aria-hidden": "true" }, button, letter);
      button.addEventListener("click", () => {
        this.open(false);
        this.chosen(table);
      });
      this.buttons.set(table, button);
    }
  }

  /** The kind of part of a table. */
  part(table: string): PalettePart | undefined {
    return this.parts.find((part) => part.table === table);
  }

  /** As a click on its button would. */
  press(table: string): void {
    this.buttons.get(table)?.click();
  }

  /** Show what to pick; "" hides it. */
  tell(prompt: string): void {
    this.prompt.textContent = prompt;
    this.prompt.hidden = prompt === "";
  }

  show(tool: string): void {
    const part = this.part(tool);
    for (const [table, button] of this.buttons) button.setAttribute("aria-pressed", String(table === tool));
    this.opener.setAttribute("aria-pressed", String(part !== undefined));
    this.text.textContent = part ? (LOOKS[tool]?.[0] ?? part.title) : "Parts";
    if (part === undefined) this.tell("");
    this.icon.setAttribute("d", (LOOKS[tool] ?? LOOKS.gears!)[2]);
  }

  /** Whether parts can be drawn; otherwise the reason. */
  disable(reason: string): void {
    for (const button of [this.opener, ...this.buttons.values()]) button.disabled = reason !== "";
    this.opener.title = reason ? `Parts: ${reason}` : "Parts: slots, gears, cams and more";
  }

  private open(on: boolean): void {
    this.element.hidden = !on;
    this.opener.setAttribute("aria-expanded", String(on));
  }
}
