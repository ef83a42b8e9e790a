import { describe, expect, it } from "vitest";
import type { DesignShown, TaskSolved, TaskState } from "../src/messages";
import { inOneLine, soundFirst, verdict } from "../src/task/designs_table";
import { radiusOf } from "../src/task/handles";
import { goalsOf, problemOf } from "../src/task/task_form";
import { distance, front, resampled, roundedTo, type Place } from "../src/task/geometry";

describe("a drawn curve", () => {
  const circle = Array.from({ length: 50 }, (_, k): Place => [Math.cos(k / 8), Math.sin(k / 8)]);
  it("is closed where it returns, and its points have equal distances", () => {
    const found = resampled(circle, 12);
    const gaps = found.map((place, k) => distance(place, found[(k + 1) % 12]!));
    expect(found).toHaveLength(12);
    expect(Math.max(...gaps) - Math.min(...gaps)).toBeLessThan(0.02);
  });
  it("keeps its ends where it is open", () => {
    const found = resampled([[0, 0], [3, 0], [10, 0]], 5);
    expect(found.map(([x]) => x)).toEqual([0, 2.5, 5, 7.5, 10]);
  });
  it("of one place is that place", () => {
    expect(resampled([[1, 2], [1, 2]], 5)).toEqual([[1, 2]]);
  });
});

describe("the front of a trade-off", () => {
  it("has the designs that no other one beats in both numbers", () => {
    const sizes: Place[] = [[3, 50], [1, 20], [2, 40], [2, 30], [4, 45], [5, 50], [6, 60]];
    expect(front(sizes)).toEqual([1, 2, 0, 6]);
  });
});

describe("numbers of a drag", () => {
  it("have the decimals that the screen shows, and no negative zero", () => {
    expect(roundedTo(12.3456, 0.1)).toBe(12.3);
    expect(roundedTo(1234.6, 10)).toBe(1235);
    expect(Object.is(roundedTo(-0.0004, 0.1), 0)).toBe(true);
  });
});

describe("the goals of an improvement", () => {
  it("are read from the entries of the task, with what varies", () => {
    const entries = { "improve.goals.0.of": "stroke(d)", "improve.goals.0.target": 70, "improve.goals.1.of": "B.y", "improve.goals.1.values.0": 1, "improve.goals.1.values.1": 2, "improve.goals.1.at.0": 10, "improve.goals.1.at.1": 20, "improve.vary": "O2 A, A B" };
    expect(goalsOf({ entries })).toEqual(["Goal: stroke(d) = 70", "Goal: B.y = 1, 2 at 10, 20", "Varied: O2 A, A B"]);
    expect(goalsOf({ entries: {} })).toEqual([]);
  });
});

describe("the verdict on a task without a sound design", () => {
  const solved = (about: Partial<TaskSolved>): TaskSolved => ({ count: 3, sound: 0, interrupted: false, most_restrictive: "", costs: 0, advice: "", ...about }) as TaskSolved;
  it("names the requirement to blame, else what to change", () => {
    expect(verdict(solved({ most_restrictive: "the driven range", costs: 2 }), "motion")).toMatch(/The requirement that rejects the most designs is the driven range: without it 2/);
    expect(verdict(solved({ most_restrictive: "the driven range", costs: 2, advice: "The best is 40°." }), "motion")).toMatch(/2 more would do. The best is 40°.$/);
    expect(verdict(solved({ advice: "Try to move a position." }), "motion")).toBe("No design is free of defects (3 designs). Try to move a position.");
    expect(verdict(solved({ count: 0, advice: "Start nearer." }), "improve")).toBe("No start leads to a design. Start nearer.");
    expect(verdict(solved({ count: 0 }), "motion")).toBe("No mechanism of the wanted kinds solves the task.");
  });
});

describe("designs of several origins", () => {
  it("are listed sound ones first, else in their order", () => {
    const designs = [[1, false], [2, true], [3, false], [4, true]].map(([index, sound]) => ({ index, sound }) as unknown as DesignShown);
    expect(soundFirst(designs).map(({ index }) => index)).toEqual([2, 4, 1, 3]);
  });
  it("have a bound that is rounded down", () => {
    const design = { mechanism: "four-bar", drive: "B0", transmission: 40.0546, size: 314.26 } as DesignShown;
    expect(inOneLine(design, { angle_unit: "deg", length_unit: "mm" } as TaskState)).toBe("four-bar driven at B0, transmission angle ≥ 40.05°, longest link 314.3 mm");
  });
});

describe("rings of positions", () => {
  it("are smaller where they would cover each other", () => {
    expect(radiusOf([[0, 0]])).toBe(10);
    expect(radiusOf([[0, 0], [30, 0], [30, 16]])).toBe(8);
    expect(radiusOf([[0, 0], [3, 0]])).toBe(4);
    expect(radiusOf(Array.from({ length: 13 }, (_, k): Place => [100 * k, 0]))).toBe(4);
  });
});

describe("a problem of the task", () => {
  it("is told at the field of its entry", () => {
    const problems = [{ line: 21, key: "wanted.transmission.least", message: "must be below 90" }, { line: 3, key: "positions[2].point[1]", message: "must be a number" }];
    expect(problemOf({ problems }, "wanted.transmission.least")).toBe("must be below 90");
    expect(problemOf({ problems }, "positions.1.point.0")).toBe("must be a number");
    expect(problemOf({ problems }, "positions.0.point.0")).toBe("");
  });
});
