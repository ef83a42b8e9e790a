// The button that changes between light and dark.

import { html } from "./svg";

/** Add the button to a heading; `root` has the theme, by default that of the system. */
export function themeButton(heading: Element, root: HTMLElement): void {
  const button = html("button", { type: "button", class: "lw-theme", "aria-label": "Light or dark" }, heading, "◐");
  button.title = "Light or dark";
  button.addEventListener("click", () => {
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const now = root.dataset.theme ?? (dark ? "dark" : "light");
    root.dataset.theme = now === "dark" ? "light" : "dark";
  });
}
