// The quantities that the program computes for the plots of the page.

import type { Mounted } from "../mount";
import type { QuantitiesListed } from "../messages";
import type { Desk } from "./asking";

export class Plots {
  private page: Mounted | null = null;
  private listed = false;

  constructor(private readonly desk: Desk) {}

  attach(page: Mounted): void {
    this.page = page;
    this.listed = false;
    page.charts.ask = (names) => this.desk.background({ kind: "show_quantities", names });
  }

  /** The file has changed: its quantities may differ. */
  renew(): void {
    this.listed = false;
  }

  /** A motion is displayed: list its quantities once. */
  moved(): void {
    if (this.listed || !this.page) return;
    this.listed = true;
    this.desk.background({ kind: "list_quantities" });
  }

  told({ quantities }: QuantitiesListed): void {
    const more = quantities.map(({ name, unit, derivatives }) => {
      const group = name.includes(".") ? "Computed on request" : "Others";
      return { name, shown: name, unit, group, orders: derivatives };
    });
    this.page?.charts.offer(more);
  }
}
