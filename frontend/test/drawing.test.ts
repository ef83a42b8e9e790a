import { describe, expect, it } from "vitest";
import { anchorAt, footOn, linkAt, pointAt, tidy, type Sketch } from "../src/live/draw/geometry";
import { freeName, freePoints } from "../src/live/draw/names";
import { linkBetween, pointOn, sliderAt } from "../src/live/draw/drawn_edits";
import { boxOf, viewOf, zoomed } from "../src/view_box";

const sketch: Sketch = {
  points: { A: [0, 0], B: [30, 40], C: [100, 40], P: [60, 90] },
  links: [
    { name: "ground", points: ["A"] },
    { name: "crank", points: ["A", "B"] },
    { name: "plate", points: ["B", "C", "P"] },
  ],
};
const file = { ...sketch, parts: ["s1"] };

describe("what is under the pointer", () => {
  it("is the nearest point within reach", () => {
    expect(pointAt(sketch, [1, 1], 3)).toBe("A");
    expect(pointAt(sketch, [10, 1], 3)).toBeNull();
    expect(pointAt(sketch, [1, 1], 3, new Set(["A"]))).toBeNull();
  });
  it("is a link, by its line or its area, never the ground", () => {
    expect(linkAt(sketch, [14, 21], 3)).toMatchObject({ link: "crank" });
    expect(linkAt(sketch, [63, 55], 3)).toEqual({ link: "plate", at: [63, 55] });
    expect(linkAt(sketch, [0, -30], 3)).toBeNull();
  });
  it("is the foot on a segment, not beyond its ends", () => {
    expect(footOn([0, 0], [10, 0], [4, 7])).toEqual([4, 0]);
    expect(footOn([0, 0], [10, 0], [14, 7])).toEqual([10, 0]);
    expect(footOn([3, 3], [3, 3], [9, 9])).toEqual([3, 3]);
  });
});

describe("the pointer is drawn to", () => {
  const free = { reach: 4, grid: 1 };
  it("points first, then links, then the grid", () => {
    expect(anchorAt(sketch, [2, 1], free)).toEqual({ at: [0, 0], point: "A" });
    expect(anchorAt(sketch, [15, 20.5], free)).toMatchObject({ link: "crank" });
    expect(anchorAt(sketch, [-20.3, -7.8], free)).toEqual({ at: [-20, -8] });
  });
  it("horizontal and vertical lines and the lengths of other links", () => {
    expect(anchorAt(sketch, [-50.4, -60.9], { ...free, from: [-80, -60] })).toMatchObject({ hint: "horizontal" });
    expect(anchorAt(sketch, [-79.5, -10.4], { ...free, from: [-80, -60] })).toEqual({ at: [-80, -10], hint: "vertical, = A B" });
  });
  it("nothing that is itself dragged", () => {
    expect(anchorAt(sketch, [1, 1], { ...free, except: new Set(["A"]) })).toEqual({ at: [1, 1] });
  });
});

describe("new things", () => {
  it("have free names", () => {
    expect(freePoints(["a", "C"], 3)).toEqual(["B", "D", "F"]);
    expect(freePoints("ABCDFGHJKLMNPQRSTUVWXYZ", 1)).toEqual(["A1"]);
    expect(freeName(["link2", "Link3"], "link", 2)).toBe("link4");
  });
  it("are links between points that exist or are new", () => {
    expect(linkBetween(file, { at: [30, 40], point: "B" }, { at: [9, 9] })).toEqual([
      { kind: "add_point", name: "D", x: 9, y: 9, links: [] },
      { kind: "add_link", name: "link2", points: ["B", "D"] },
    ]);
    expect(linkBetween(file, { at: [15, 20], link: "crank" }, { at: [100, 40], point: "C" })).toEqual([
      { kind: "add_point", name: "D", x: 15, y: 20, links: ["crank"] },
      { kind: "add_link", name: "link2", points: ["D", "C"] },
    ]);
  });
  it("are no links without length, and none where one exists", () => {
    expect(linkBetween(file, { at: [5, 5] }, { at: [5, 5] })).toBeNull();
    expect(linkBetween(file, { at: [0, 0], point: "A" }, { at: [30, 40], point: "B" })).toBeNull();
  });
  it("are points of links, with their path if that is wanted", () => {
    expect(pointOn(file, "crank", [3, 4], true)).toEqual([
      { kind: "add_point", name: "D", x: 3, y: 4, links: ["crank"] },
      { kind: "trace_point", point: "D", on: true },
    ]);
  });
  it("are blocks on a fixed line", () => {
    const edits = sliderAt(file, "C", [100, 40], [110, 40], 20);
    expect(edits[0]).toMatchObject({ x: 80, y: 40 });
    expect(edits[1]).toMatchObject({ x: 120, y: 40 });
    expect(edits[4]).toMatchObject({ table: "sliders", typed: { name: "s2", link: "block1", line: ["D", "F"] } });
  });
});

describe("the view", () => {
  it("keeps the place under the pointer when it is zoomed", () => {
    const before = { x: 10, y: 20, width: 100 };
    const after = zoomed(before, 2, [35, 20]);
    expect(after).toEqual({ x: 22.5, y: 20, width: 50 });
    expect((35 - after.x) / after.width).toBeCloseTo((35 - before.x) / before.width, 12);
  });
  it("contains the whole box in any window", () => {
    const [left, bottom, right, top] = boxOf(viewOf([0, 0, 10, 40], 200, 100), 200, 100);
    expect([left, bottom, right, top]).toEqual([-35, 0, 45, 40]);
  });
  it("has coordinates of few digits", () => {
    expect(tidy(12.3456789, 1)).toBe(12.35);
    expect(Object.is(tidy(-0.0001, 1), 0)).toBe(true);
  });
});
