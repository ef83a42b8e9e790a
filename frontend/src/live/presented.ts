// The presentation of the live page: Newton's steps beside the drawing, stepped by keys, or a
// simulation with its charts.

import type { Mounted } from "../mount";
import type { Newton } from "./newton";
import type { Tabs } from "./tabs";

/** Show Newton's steps while a page presents, but for a simulation; `begin` leaves the editing of
 * the drawing. */
export function presentNewton(page: Mounted, tabs: Tabs, newton: Newton, simulated: () => boolean, begin: () => void): void {
  const { presentation } = page;
  let before = 0;
  const steps = (): boolean => !simulated();
  presentation.also([
    { keys: ["ArrowRight"], does: "Newton's next step", when: steps, act: () => newton.step(1) },
    { keys: ["ArrowLeft"], does: "Newton's step before", when: steps, act: () => newton.step(-1) },
  ]);
  presentation.changed = (on) => {
    if (on) {
      begin();
      before = tabs.chosen;
    }
    tabs.choose(on ? tabs.indexOf(steps() ? "Newton" : "Simulate") : before);
  };
}
