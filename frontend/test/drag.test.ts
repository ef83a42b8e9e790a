import { describe, expect, it } from "vitest";
import { stepTowards, type Step } from "../src/drag";

const circle = (count: number): Float64Array =>
  Float64Array.from(
    Array.from({ length: count }, (_, k) => (2 * Math.PI * k) / count).flatMap((a) => [Math.cos(a), Math.sin(a)]),
  );

/** The pin of a rocker: forth and back on one arc, as on a closed circuit. */
const rocker = (count: number): Float64Array =>
  Float64Array.from(
    Array.from({ length: count }, (_, k) => Math.cos((2 * Math.PI * k) / count)).flatMap((a) => [
      Math.sin(a),
      Math.cos(a),
    ]),
  );

const start = (at: number): Step => ({ at, sense: 0 });

describe("dragging along a way", () => {
  it("takes the nearest row", () => {
    const step = stepTowards(circle(360), true, start(10), 2 * Math.cos(0.7), 2 * Math.sin(0.7));
    expect(step).toEqual({ at: 40, sense: 1 });
  });

  it("goes over the seam of a closed way, and not over that of an open one", () => {
    const towards = [Math.cos(-0.1), Math.sin(-0.1)] as const;
    expect(stepTowards(circle(360), true, start(3), ...towards).at).toBe(354);
    expect(stepTowards(circle(360), false, start(3), ...towards).at).toBe(0);
  });

  it("keeps to its side of the way where both sides are as near", () => {
    const step = stepTowards(rocker(360), true, start(60), Math.sin(0.2), Math.cos(0.2));
    expect(step.at).toBeGreaterThan(60);
    expect(step.at).toBeLessThan(120);
  });

  it("goes on through a dead point in the direction that it had", () => {
    const way = rocker(360);
    let step: Step = { at: 150, sense: 1 };
    for (const angle of [-0.9, -0.97, -1.05, -0.97, -0.9]) {
      step = stepTowards(way, true, step, Math.sin(angle), Math.cos(angle));
    }
    expect(step.at).toBeGreaterThan(180);
    expect(Math.sin(Math.cos((2 * Math.PI * step.at) / 360))).toBeCloseTo(Math.sin(-0.9), 1);
  });

  it("goes on through a dead point backwards, too", () => {
    const way = rocker(360);
    let step: Step = { at: 210, sense: -1 };
    for (const angle of [-0.9, -0.97, -1.05, -0.97, -0.9]) {
      step = stepTowards(way, true, step, Math.sin(angle), Math.cos(angle));
    }
    expect(step.at).toBeLessThan(180);
    expect(step.at).toBeGreaterThan(120);
  });

  it("stays where it is nearest already", () => {
    expect(stepTowards(circle(360), true, { at: 90, sense: -1 }, 0, 5)).toEqual({ at: 90, sense: -1 });
  });
});
