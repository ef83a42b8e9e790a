// The quantities that the program computes for the plots of the page.

import type { Mounted } from "../mount";
import type { QuantitiesListed } from "../messages";
import type { Desk } from "./asking";

export class Plots {
  private page: Mounted | null = null;
  private listed = false;
  /** Whether the displayed motion is a simulation. */
  simulated = false;

  constructor(private readonly desk: Desk) {}

  attach(page: Mounted): void {
    this.page = page;
    this.listed = false;
    page.charts.ask = (names) => this.desk.background({ kind: "show_quantities", names, simulated: this.simulated });
  }

  /** The file has changed: its quantities may differ. */
  renew(): void {
    this.listed = false;
  }

  /** Another motion is displayed: it may have other quantities. */
  turned(): void {
    this.page?.charts.askAgain();
    this.listed = false;
    this.moved();
  }

  /** A motion is displayed: list its quantities once. */
  moved(): void {
    if (this.listed || !this.page) return;
    this.listed = true;
    this.desk.background({ kind: "list_quantities", simulated: this.simulated });
  }

  told({ quantities }: QuantitiesListed): void {
    const more = quantities.map(({ name, unit, derivatives }) => {
      const group = name.includes(".") ? "Computed on request" : "Others";
      return { name, shown: name, unit, group, orders: derivatives };
    });
    this.page?.charts.offer(more);
  }
}
