import { describe, expect, it } from "vitest";
import type { TaskSolved } from "../src/messages";
import { verdict } from "../src/task/designs_table";
import { goalsOf } from "../src/task/task_form";
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
  const solved = (about: Partial<TaskSolved>): TaskSolved => ({ count: 3, sound: 0, interrupted: false, costliest: "", costs: 0, advice: "", ...about }) as TaskSolved;
  it("names the wish to blame, else what to change", () => {
    expect(verdict(solved({ costliest: "the driven range", costs: 2 }), "motion")).toMatch(/The wish that costs most is the driven range: without it 2/);
    expect(verdict(solved({ advice: "Try to move a position." }), "motion")).toBe("No design is free of defects (3 designs). Try to move a position.");
    expect(verdict(solved({ count: 0, advice: "Start nearer." }), "improve")).toBe("No start leads to a design. Start nearer.");
    expect(verdict(solved({ count: 0 }), "motion")).toBe("No mechanism of the wanted kinds solves the task.");
  });
});
