import { describe, expect, it } from "vitest";
import { lineOf } from "../src/live/draw/dimension_lines";
import { angleAt, outputOf, told } from "../src/live/draw/measuring";
import { growth, scaled } from "../src/live/draw/photograph";

const [A, B, C] = [{ at: [0, 0], point: "A" }, { at: [30, 40], point: "B" }, { at: [30, 90], point: "C" }] as const;

describe("a measure", () => {
  it("is a distance with its parts, or an angle", () => {
    expect(told([A], "mm", "deg")).toBe("");
    expect(told([A, B], "mm", "deg")).toBe("A B: 50 mm (horizontal 30, vertical 40)");
    expect(told([A, { at: [-3, -4] }], "", "deg")).toBe("Distance: 5 (horizontal 3, vertical 4)");
    expect(told([{ at: [1, 0] }, { at: [0, 0] }, { at: [0, 2] }], "mm", "deg")).toBe("Angle: 90°");
    expect(told([A, B, C], "mm", "rad")).toMatch(/^A B C: −?2.49809 rad$/);
    expect(angleAt([1, 0], [0, 0], [0, -2])).toBeCloseTo(-Math.PI / 2, 14);
  });
  it("is an output if it is between points", () => {
    expect(outputOf([A, B])).toEqual({ base: "distance", formula: "hypot(B.x - A.x, B.y - A.y)" });
    expect(outputOf([A, B, C])!.base).toBe("angle");
    expect(outputOf([A, { at: [1, 2] }])).toBeNull();
    expect(outputOf([A, B, { at: [1, 2] }])).toBeNull();
    expect(outputOf([A])).toBeNull();
  });
});

describe("a dimension line", () => {
  it("is beside its length, away from the centre", () => {
    expect(lineOf([0, 0], [10, 0], [5, 9], 2)).toEqual([[0, -2], [10, -2]]);
    expect(lineOf([0, 0], [10, 0], [5, -9], 2)).toEqual([[0, 2], [10, 2]]);
    expect(lineOf([0, 0], [10, 0], [5, 0], 2)).toEqual([[0, 2], [10, 2]]);
  });
});

describe("a photograph", () => {
  it("is scaled by one known length, whose first end stays", () => {
    const picture = { data: "", x: 0, y: 10, width: 100, height: 50, opacity: 1 };
    expect(growth({ A: [0, 0], B: [30, 40] }, { A: [0, 0], B: [3, 4] })).toBeCloseTo(0.1, 15);
    expect(growth({}, {})).toBe(1);
    expect(scaled(picture, [10, 10], [20, 10], 5)).toEqual({ ...picture, x: 5, y: 10, width: 50, height: 25 });
  });
});
