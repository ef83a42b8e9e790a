// Tabs: panels of which one is shown.

import { html } from "../svg";

export interface Panel {
  readonly title: string;
  readonly element: HTMLElement;
  /** Called when the panel is shown or hidden. */
  readonly shown?: (on: boolean) => void;
}

let made = 0;

export class Tabs {
  readonly element: HTMLElement;
  private readonly buttons: HTMLButtonElement[] = [];
  private at = 0;

  constructor(private readonly panels: readonly Panel[]) {
    this.element = html("div", { class: "lw-tabs" });
    const list = html("div", { class: "lw-tablist", role: "tablist", "aria-label": "Editing" }, this.element);
    const own = `lw-tabs-${++made}`;
    panels.forEach((panel, k) => {
      const button = html("button", { type: "button", role: "tab", id: `${own}-${k}` }, list, panel.title);
      button.setAttribute("aria-controls", `${own}-panel-${k}`);
      button.addEventListener("click", () => this.choose(k));
      this.buttons.push(button);
      panel.element.id = `${own}-panel-${k}`;
      panel.element.setAttribute("role", "tabpanel");
      panel.element.setAttribute("aria-labelledby", button.id);
      panel.element.classList.add("lw-panel");
      this.element.append(panel.element);
    });
    list.addEventListener("keydown", (event) => this.key(event));
    this.mark();
  }

  /** The number of the panel in sight. */
  get chosen(): number {
    return this.at;
  }

  indexOf(title: string): number {
    return this.panels.findIndex((panel) => panel.title === title);
  }

  choose(k: number): void {
    if (k === this.at) return;
    this.panels[this.at]!.shown?.(false);
    this.at = k;
    this.mark();
    this.panels[k]!.shown?.(true);
  }

  private mark(): void {
    this.panels.forEach((panel, k) => {
      panel.element.hidden = k !== this.at;
      this.buttons[k]!.setAttribute("aria-selected", String(k === this.at));
      this.buttons[k]!.tabIndex = k === this.at ? 0 : -1;
    });
  }

  private key(event: KeyboardEvent): void {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    this.choose((this.at + by + this.panels.length) % this.panels.length);
    this.buttons[this.at]!.focus();
  }
}
