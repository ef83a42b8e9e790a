// The button that changes between light and dark.

import { html } from "./svg";

/** Adds it to a heading; `root` is what wears the theme, or else the system's. */
export function themeButton(heading: Element, root: HTMLElement): void {
  const button = html("button", { type: "button", class: "lw-theme", "aria-label": "Light or dark" }, heading, "◐");
  button.title = "Light or dark";
  button.addEventListener("click", () => {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const now = root.dataset.theme ?? (dark ? "dark" : "light");
    root.dataset.theme = now === "dark" ? "light" : "dark";
  });
}
