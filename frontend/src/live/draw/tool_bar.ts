// The tools of the drawing: a button with a symbol and a key for each.

import type { PalettePart } from "../../messages";
import { html, svg } from "../../svg";
import { PartTools } from "./part_tools";

export interface Tool {
  readonly name: string;
  readonly key: string;
  readonly title: string;
  /** What to do with it, in one line. */
  readonly use: string;
  /** Its symbol, in a square of 24. */
  readonly icon: string;
}

export const TOOLS: readonly Tool[] = [
  { name: "move", key: "m", title: "Move", use: "Drag a pin or a link to move the mechanism.", icon: "M8 12V6.5a1.5 1.5 0 0 1 3 0V11m0-5.5a1.5 1.5 0 0 1 3 0V11m0-4.5a1.5 1.5 0 0 1 3 0V14c0 4-2.5 6.5-6 6.5-3 0-4.5-1.5-7-6.5-.7-1.4 1.2-2.4 2.2-1.2L8 14.500" },
  { name: "select", key: "v", title: "Select", use: "Click a pin or a link to change it; drag it to reshape the links at it. Drag from empty space to select several.", icon: "M6 4l12 8-5.500 1.200L10 19z" },
  { name: "link", key: "l", title: "Link", use: "Drag from one end of a new link to the other. Ends join pins and links that they are dropped on.", icon: "M6.500 17.500L17.500 6.500M6.500 17.500m-2.500 0a2.500 2.500 0 1 0 5 0a2.500 2.500 0 1 0-5 0M17.500 6.500m-2.500 0a2.500 2.500 0 1 0 5 0a2.500 2.500 0 1 0-5 0" },
  { name: "point", key: "p", title: "Point", use: "Drag from a link to where its new point shall be.", icon: "M4 18L20 18L12 6zM12 6m-2.200 0a2.200 2.200 0 1 0 4.400 0a2.200 2.200 0 1 0-4.400 0" },
  { name: "slider", key: "s", title: "Slider", use: "Drag from a pin in the direction in which its block slides; click for a horizontal one.", icon: "M3 17h18M7 9h10v6H7zM12 12m-1.200 0a1.200 1.200 0 1 0 2.400 0a1.200 1.200 0 1 0-2.400 0" },
  { name: "ground", key: "g", title: "Ground", use: "Click a pin to fix it to the ground, or to release it.", icon: "M12 4m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0M12 6l5 8H7zM4 14h16M6 14l-3 4M11 14l-3 4M16 14l-3 4" },
  { name: "drive", key: "d", title: "Drive", use: "Click the link or block that is driven.", icon: "M12 4a8 8 0 1 1-7.700 5.800M4 5v5h5" },
  { name: "trace", key: "t", title: "Trace", use: "Click a pin, or a place on a link, to see its path.", icon: "M4 16c2-9 6-10 8-5s5 6 8-3M12 11m-1.800 0a1.800 1.800 0 1 0 3.600 0a1.800 1.800 0 1 0-3.600 0" },
];

export class ToolBar {
  readonly element = html("div", { class: "lw-tools", role: "toolbar", "aria-label": "Drawing", "aria-orientation": "vertical" });
  readonly parts: PartTools;
  private readonly buttons = new Map<string, HTMLButtonElement>();

  constructor(chosen: (name: string) => void) {
    this.parts = new PartTools(chosen);
    for (const { name, key, title, use, icon } of TOOLS) {
      const button = html("button", { type: "button", "aria-pressed": "false", title: `${title} (${key.toUpperCase()}): ${use}` }, this.element);
      button.setAttribute("aria-label", title);
      button.setAttribute("aria-keyshortcuts", key.toUpperCase());
      svg("path", { d: icon }, svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, button));
      html("span", {}, button, title);
      button.addEventListener("click", () => chosen(name));
      this.buttons.set(name, button);
    }
    this.element.append(this.parts.opener);
  }

  /** The kind of part that a tool draws. */
  part(name: string): PalettePart | undefined {
    return this.parts.part(name);
  }

  /** As a click would: not if it is disabled. */
  press(name: string): void {
    this.buttons.get(name)?.click();
    this.parts.press(name);
  }

  show(name: string): void {
    for (const [own, button] of this.buttons) button.setAttribute("aria-pressed", String(own === name));
    this.parts.show(name);
  }

  /** Tools that cannot be used, with the reason. */
  disable(names: readonly string[], reason: string): void {
    this.parts.disable(names.includes("link") ? reason : "");
    for (const [own, button] of this.buttons) {
      button.disabled = names.includes(own);
      const { title, key, use } = TOOLS.find((tool) => tool.name === own)!;
      button.title = button.disabled ? `${title}: ${reason}` : `${title} (${key.toUpperCase()}): ${use}`;
    }
  }
}
