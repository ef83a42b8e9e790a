// A hint for the first visit, which stays closed once it is closed.

import { html } from "../svg";

const KEY = "linkwork-hint-closed";

/** Storage may be forbidden, as in a sandboxed frame: then the hint is closed for this visit. */
function closed(): boolean {
  try {
    return localStorage.getItem(KEY) !== null;
  } catch {
    return false;
  }
}

const LINES: readonly string[] = [
  "Drag a pin: it moves.",
  "Choose Select, then drag: lengths change.",
  "Choose Link: draw more.",
  "? lists all keys.",
];

/** The hint, or null if it has been closed. */
export function firstHint(): HTMLElement | null {
  if (closed()) return null;
  const box = html("aside", { class: "lw-first", "aria-label": "First steps" });
  const list = html("ul", {}, box);
  for (const line of LINES) html("li", {}, list, line);
  const close = html("button", { type: "button", class: "lw-close", "aria-label": "Close the first steps" }, box, "×");
  close.addEventListener("click", () => {
    box.remove();
    try {
      localStorage.setItem(KEY, "1");
    } catch {
      // it is shown again next time
    }
  });
  return box;
}
