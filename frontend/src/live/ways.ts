// The panel of assembly configurations.

import type { ConfigurationsFound } from "../messages";
import { measured } from "../numbers";
import { html } from "../svg";
import type { Desk } from "./asking";
import { pictureOf } from "./schematic";

export class Ways {
  readonly element = html("div", { class: "lw-ways" });
  private readonly state: HTMLElement;
  private readonly list: HTMLElement;
  private on = false;

  constructor(private readonly desk: Desk) {
    html("p", { class: "lw-lead" }, this.element, "All assembly configurations of the links at the current input. Choose one to move it.");
    const find = html("button", { type: "button" }, this.element, "List again at this position");
    find.addEventListener("click", () => this.find());
    this.state = html("p", { class: "lw-summary", role: "status" }, this.element);
    this.list = html("div", { class: "lw-way-list" }, this.element);
  }

  shown(on: boolean): void {
    this.on = on;
    if (on) this.find();
  }

  /** The file has changed: the list may be outdated. */
  renew(): void {
    if (this.on) this.find();
  }

  show(found: ConfigurationsFound): void {
    const { file } = this.desk;
    const where = Object.entries(found.input).map(([name, value]) => {
      const unit = file().inputs.find((one) => one.name === name)?.unit ?? "";
      return `${name} = ${measured(value, unit)}`;
    });
    this.state.textContent = [where.join(", "), found.completeness].filter(Boolean).join(": ");
    this.list.replaceChildren();
    for (const way of found.ways) {
      const button = html("button", { type: "button", class: "lw-way" }, this.list);
      const current = same(way.unknowns, this.desk.values(), file().angle_unit === "rad" ? 2 * Math.PI : 360);
      button.setAttribute("aria-pressed", String(current));
      if (file().links.length) button.append(pictureOf(file().links, way.points, [], false));
      html("span", {}, button, way.name || written(way.unknowns));
      button.disabled = way.name === "";
      button.addEventListener("click", () => this.desk.ask({ kind: "choose_configuration", name: way.name }));
    }
  }

  private find(): void {
    this.state.textContent = "Finding all configurations …";
    this.desk.ask({ kind: "list_configurations", at: this.desk.here() });
  }
}

/** Whether a configuration is the displayed one; angles are compared modulo whole turns. */
export function same(
  unknowns: Readonly<Record<string, number>>,
  shown: Readonly<Record<string, number>>,
  turn: number,
): boolean {
  return Object.entries(unknowns).every(([name, value]) => {
    const off = Math.abs(value - (shown[name] ?? NaN));
    const turned = Math.abs(off - turn * Math.round(off / turn));
    return Math.min(off, turned) <= 1e-6 * (1 + Math.abs(value));
  });
}

function written(unknowns: Readonly<Record<string, number>>): string {
  return Object.entries(unknowns).map(([name, value]) => `${name} = ${measured(value, "")}`).join(", ");
}
