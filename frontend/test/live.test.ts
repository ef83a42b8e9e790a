import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { partOf, piecesOf } from "../src/live/build";
import { Latest, PATIENCE, UNDER_WAY } from "../src/live/latest";
import { reach, told } from "../src/live/notices";
import { clean, rangeAround, roundStep, typed } from "../src/live/ranges";
import { boxAround } from "../src/live/schematic";
import { same } from "../src/live/ways";
import type { LimitFound } from "../src/messages";

describe("requests while something is dragged", () => {
  let sent: string[] = [];
  const latest = (): Latest<string> => new Latest((request) => sent.push(request));
  beforeEach(() => {
    sent = [];
    vi.useFakeTimers();
  });
  afterEach(() => vi.useRealTimers());

  it("sends few at a time, and of those that wait only the latest", () => {
    const some = latest();
    for (const request of ["a", "b", "c", "d", "e"]) some.put(request);
    expect(sent).toEqual(["a", "b", "c", "d", "e"].slice(0, UNDER_WAY));
    some.answered(1);
    expect(sent.at(-1)).toBe("e");
    expect(sent).toHaveLength(UNDER_WAY + 1);
  });

  it("takes an answer for those before it too, and no foreign one", () => {
    const some = latest();
    for (const request of ["a", "b", "c"]) some.put(request);
    some.answered(null);
    some.answered(99);
    expect(sent).toHaveLength(UNDER_WAY);
    some.answered(2);
    expect(sent.at(-1)).toBe("c");
  });

  it("does not wait for ever", () => {
    const some = latest();
    for (const request of ["a", "b", "c"]) some.put(request);
    vi.advanceTimersByTime(1000 * PATIENCE + 1);
    expect(sent.at(-1)).toBe("c");
  });

  it("forgets what waits once the last value is asked for", () => {
    const some = latest();
    for (const request of ["a", "b", "c"]) some.put(request);
    some.clear();
    some.answered(2);
    expect(sent).not.toContain("c");
  });
});

describe("ranges of sliders", () => {
  it.each([
    [0.8, 0.5],
    [1, 1],
    [3.2, 2],
    [0.073, 0.05],
  ])("rounds a step of %d to %d", (rough, step) => expect(roundStep(rough)).toBeCloseTo(step, 12));

  it.each([
    [40, "mm"],
    [-12.345, "mm"],
    [11.5, "deg"],
    [0, "mm"],
  ])("has %d %s on one of its steps, with room on both sides", (value, unit) => {
    const { low, high, step } = rangeAround(value, unit, 100);
    expect(low).toBeLessThan(value);
    expect(high).toBeGreaterThan(value);
    const steps = (value - low) / step;
    expect(Math.abs(steps - Math.round(steps))).toBeLessThan(1e-6);
  });

  it("keeps lengths from turning over", () => expect(rangeAround(40, "mm", 100).low).toBeGreaterThan(0));

  it("cleans binary noise, and tells formulas from numbers", () => {
    expect(clean(0.1 + 0.2)).toBe(0.3);
    expect(typed(" 12.5 ")).toBe(12.5);
    expect(typed("\u221230°")).toBe(-30);
    expect(typed("2*a")).toBe("2*a");
    expect(typed("")).toBe("");
  });
});

describe("what is told", () => {
  const limit = (input: number, located = true): LimitFound => ({ what: "dead point", input, located, sentence: "" });

  it("says how much of the range is missing", () => {
    expect(reach({ limits: [], missing: 0, message: "position found" })).toBe("");
    expect(reach({ limits: [], missing: 0, message: "shown at 721 rows" })).toBe("shown at 721 rows");
    expect(reach({ limits: [limit(1), limit(2)], missing: 4, message: "" })).toBe("4 positions cannot be reached. Dead points:");
    expect(reach({ limits: [], missing: 1, message: "" })).toBe("1 position of the range cannot be reached.");
  });

  it("says where a dead point is, and whether that is an estimate", () => {
    expect(told(limit(117.62031), "deg")).toBe("117.6203°");
    expect(told(limit(-5, false), "mm")).toBe("about \u22125 mm");
  });
});

describe("configurations", () => {
  it("are the one shown if all unknowns agree but for whole turns", () => {
    expect(same({ a: 350, s: 12 }, { a: -10, s: 12, b: 3 }, 360)).toBe(true);
    expect(same({ a: 350, s: 12 }, { a: -9, s: 12 }, 360)).toBe(false);
    expect(same({ a: 350 }, {}, 360)).toBe(false);
  });
});

describe("the palette", () => {
  it("has points, links, joints and every kind of part that is offered", () => {
    const spring = { table: "springs", title: "Spring", doc: "Drawn", fields: [], picks: [] };
    const pieces = piecesOf([spring]);
    expect(pieces.map((piece) => piece.title)).toEqual(["Point", "Link", "Joint", "Spring"]);
    expect(pieces[3]!.edit({ name: "s" })).toEqual({ kind: "add_part", table: "springs", typed: { name: "s" } });
  });

  it("leaves out what was left empty", () => {
    expect(partOf("gears", { name: "g", wheels: ["a", "b"], radii: [], arm: "" })).toEqual({
      kind: "add_part",
      table: "gears",
      typed: { name: "g", wheels: ["a", "b"] },
    });
  });

  it("makes a link of the points that were chosen", () => {
    const link = piecesOf([]).find((piece) => piece.title === "Link")!;
    expect(link.edit({ name: "rod", points: ["A", "B"] })).toEqual({ kind: "add_link", name: "rod", points: ["A", "B"] });
  });
});

describe("pictures of points", () => {
  it("have room for one point, and none", () => {
    for (const points of [[], [[3, 4]]] as const) {
      const { left, right, bottom, top } = boxAround(points);
      expect(right).toBeGreaterThan(left);
      expect(top).toBeGreaterThan(bottom);
    }
  });
});
