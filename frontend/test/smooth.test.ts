import { describe, expect, it } from "vitest";
import { curveThrough, pointsThrough, type Spot } from "../src/smooth";

/** Points of a circle of radius 100, some degrees apart. */
const arc = (...degrees: number[]): Spot[] =>
  degrees.map((d) => [100 * Math.cos((d * Math.PI) / 180), 100 * Math.sin((d * Math.PI) / 180)]);

function pairs(numbers: readonly number[]): Spot[] {
  return Array.from({ length: numbers.length / 2 }, (_, k) => [numbers[2 * k]!, numbers[2 * k + 1]!]);
}

describe("smooth lines", () => {
  it("are circles through points of a circle, also at both ends and for unequal steps", () => {
    const points = pairs(pointsThrough(arc(0, 40, 50, 80, 81), 0.01));
    for (const [x, y] of points) expect(Math.hypot(x, y)).toBeCloseTo(100, 1);
    const middles = points.slice(1).map(([x, y], k) => Math.hypot(x + points[k]![0], y + points[k]![1]) / 2);
    expect(Math.min(...middles)).toBeGreaterThan(99.97);
  });

  it("are straight where a line is as good, and at corners", () => {
    expect(curveThrough(arc(0, 1, 2, 3))).not.toContain("C");
    expect(curveThrough([[0, 0], [50, 0], [50, 50], [100, 50]])).not.toContain("C");
    expect(curveThrough(arc(0, 20, 40))).toMatch(/^M100.00 0.00C.*C/);
    expect(curveThrough([])).toBe("");
    expect(curveThrough([[1, 2]])).toBe("M1.00 2.00");
  });

  it("keep points that coincide and a path that turns back", () => {
    expect(pairs(pointsThrough([[0, 0], [0, 0], [9, 1], [0, 0]], 0.01))).toEqual([[0, 0], [0, 0], [9, 1], [0, 0]]);
  });
});
