// The colours of roles as a style sheet, light and dark.

import type { PageData, RoleStyle, ThemeData } from "./page_data";

/** Rules for everything inside `scope`; line widths are in the drawing's unit. */
export function themeRules(data: PageData, scope: string): string {
  const light = colours(data.light);
  const dark = colours(data.dark);
  const tones = data.light.tones.length;
  const rules = [
    `${scope}{${light}}`,
    `@media screen and (prefers-color-scheme:dark){${scope}:not([data-theme=light]){${dark}color-scheme:dark}}`,
    `@media screen{${scope}[data-theme=dark]{${dark}color-scheme:dark}}`,
    `${scope}[data-theme=light]{color-scheme:light}`,
    `${scope} .tone-0{--tone:var(--driven)}`,
    `${scope} .tone-ground{--tone:var(--ground)}`,
  ];
  for (let k = 1; k <= tones; k++) rules.push(`${scope} .tone-${k}{--tone:var(--tone-${k})}`);
  for (const style of data.light.styles) rules.push(...roleRules(style, data.stroke, scope));
  return rules.join("\n");
}

/** The class of a tone. */
export function toneClass(tone: number, data: PageData): string {
  if (tone < 0) return "tone-ground";
  return tone === 0 ? "tone-0" : `tone-${((tone - 1) % data.light.tones.length) + 1}`;
}

function colours(theme: ThemeData): string {
  const found = [
    `--page:${theme.background}`,
    `--ink:${theme.ink}`,
    `--faint:color-mix(in srgb,${theme.faint} 68%,${theme.ink})`,
    `--ground:${theme.faint}`,
    `--driven:${theme.driven}`,
    ...theme.tones.map((tone, k) => `--tone-${k + 1}:${tone}`),
  ];
  for (const style of theme.styles) {
    found.push(`--line-${style.role}:${colour(style.line)}`);
    found.push(`--fill-${style.role}:${colour(style.fill)}`);
  }
  return `${found.join(";")};`;
}

function colour(value: string): string {
  return value === "tone" || value === "" ? "none" : value;
}

function roleRules(style: RoleStyle, stroke: number, scope: string): string[] {
  const line = style.line === "tone" ? "var(--tone)" : `var(--line-${style.role})`;
  const fill = style.fill === "tone" ? "var(--tone)" : `var(--fill-${style.role})`;
  const width = Number((style.width * stroke).toPrecision(5));
  const dashes = style.dashes.map((part) => Number((part * width).toPrecision(4))).join(" ");
  const own = `${scope} .r-${style.role}`;
  return [
    `${own}{stroke:${line};stroke-width:calc(${width}px*var(--thick,1));fill:none;` +
      (dashes ? `stroke-dasharray:${dashes};` : "") +
      "stroke-linecap:round;stroke-linejoin:round}",
    `${own}.filled{fill:${fill};fill-opacity:${style.opacity}}`,
  ];
}
