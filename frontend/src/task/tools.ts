// The tools of the canvas of a task.

import { iconButton } from "../live/draw/icon_button";
import type { TaskState } from "../messages";
import { html } from "../svg";

export type Tool = "move" | "position" | "curve" | "pivot" | "region" | "obstacle";

interface Offered {
  readonly tool: Tool;
  readonly name: string;
  readonly key: string;
  readonly does: string;
  readonly icon: string;
  /** The kinds of tasks that have a use for it. */
  readonly of: readonly string[];
}

const PLACED = ["motion", "path", "mixed"];

export const TOOLS: readonly Offered[] = [
  { tool: "move", name: "Move", key: "v", does: "Drag what is there", icon: "M6 3l12 9-6 1-3 6z", of: [...PLACED, "function", "improve"] },
  { tool: "position", name: "Position", key: "p", does: "Add a position at the end", icon: "M12 5v14M5 12h14", of: PLACED },
  { tool: "curve", name: "Curve", key: "c", does: "Draw the curve of a point with the pointer", icon: "M3 17c3-12 7-12 9-5s6 5 9-6", of: ["path"] },
  { tool: "pivot", name: "Pivot", key: "f", does: "Fix a pivot; of four poses on their centre-point curve", icon: "M12 5l7 11H5zM4 19h16", of: PLACED },
  { tool: "region", name: "Region", key: "r", does: "Draw a box that must contain all fixed pivots", icon: "M4 6h16v12H4z", of: PLACED },
  { tool: "obstacle", name: "Obstacle", key: "o", does: "Draw a circle that no link may meet", icon: "M12 4a8 8 0 1 0 .01 0M7 7l10 10", of: PLACED },
];

export class ToolBar {
  readonly element = html("div", { class: "lw-tools", role: "toolbar", "aria-label": "Tools" });
  private readonly buttons = new Map<Tool, HTMLButtonElement>();

  constructor(chosen: (tool: Tool) => void) {
    for (const { tool, name, key, does, icon } of TOOLS) {
      const button = iconButton(name, `${name} (${key.toUpperCase()}): ${does}`, icon);
      button.setAttribute("aria-keyshortcuts", key.toUpperCase());
      html("span", {}, button, name);
      button.addEventListener("click", () => chosen(tool));
      this.buttons.set(tool, button);
      this.element.append(button);
    }
    this.choose("move");
  }

  show(task: TaskState): void {
    for (const { tool, of } of TOOLS) this.buttons.get(tool)!.hidden = !of.includes(task.task);
  }

  choose(tool: Tool): void {
    for (const [own, button] of this.buttons) button.setAttribute("aria-pressed", String(own === tool));
  }
}
