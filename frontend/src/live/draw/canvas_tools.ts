// Tools beside those that draw: zoom, duplicates and mirror images.

import type { Mounted } from "../../mount";
import type { Desk } from "../asking";
import type { Editor } from "./editor";
import { Selected } from "./selected";
import { Zoom } from "./zoom";

export class CanvasTools {
  private readonly zoom = new Zoom();
  private readonly selected: Selected;
  private gone = new AbortController();

  constructor(desk: Desk, editor: Editor) {
    this.selected = new Selected(desk, () => editor.held);
    editor.inspector.more = (panel) => this.selected.fill(panel);
  }

  attach(page: Mounted): void {
    this.gone.abort();
    this.gone = new AbortController();
    this.zoom.attach(page);
    document.addEventListener("keydown", (event) => this.key(event), { capture: true, signal: this.gone.signal });
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (document.querySelector("dialog[open]") || target.closest("input, textarea, select") || event.altKey) return;
    const ctrl = event.ctrlKey || event.metaKey;
    if (ctrl && event.key.toLowerCase() === "d") this.selected.duplicate();
    else if (ctrl || !this.zoom.key(event.key)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }
}
