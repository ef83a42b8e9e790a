// A button with a symbol, pressed or not.

import { html, svg } from "../../svg";

/** `icon`: its lines, in a square of 24. */
export function iconButton(label: string, title: string, icon: string): HTMLButtonElement {
  const button = html("button", { type: "button", "aria-pressed": "false", "aria-label": label, title });
  svg("path", { d: icon }, svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true" }, button));
  return button;
}
