import { describe, expect, it } from "vitest";
import { centreOf, duplicate, mirror, mirrored, selectionOf } from "../src/live/draw/copies";
import type { FileState } from "../src/messages";

const points = { A: [0, 0], B: [30, 40], C: [100, 40], P: [60, 90] } as const;
const file = {
  points,
  links: [
    { name: "ground", points: ["A", "C"] },
    { name: "link2", points: ["A", "B"] },
    { name: "plate", points: ["B", "C", "P"] },
  ],
  parts: ["D"],
  numbers: [{ name: "F" }],
} as unknown as FileState;

describe("a selection", () => {
  it("has the links between its points, never the ground", () => {
    expect(selectionOf(file, new Set(["A", "B", "C"]))).toEqual({ points: ["A", "B", "C"], links: ["link2"] });
    expect(selectionOf(file, new Set(["B"]), "plate")).toEqual({ points: ["B", "C", "P"], links: ["plate"] });
  });
  it("is copied under the next free names", () => {
    const edit = duplicate(file, points, selectionOf(file, new Set(["A", "B"])), ([x, y]) => [x + 10, y]);
    expect(edit).toEqual({ kind: "duplicate", names: { A: "G", B: "H", link2: "link3" }, places: { A: [10, 0], B: [40, 40] }, mirrored: false });
  });
  it("shares the points on the line of a mirror", () => {
    const line = { at: [30, 0], along: [0, 2] } as const;
    const edit = duplicate(file, points, selectionOf(file, new Set(["B"]), "link2"), (at) => mirrored(at, line), true);
    expect(edit).toEqual({ kind: "duplicate", names: { A: "G", B: "B", link2: "link3" }, places: { A: [60, 0] }, mirrored: true });
  });
});

describe("a mirror", () => {
  it("keeps distances from its line", () => {
    expect(mirrored([3, 1], { at: [0, 0], along: [1, 1] })).toEqual([1, 3]);
    expect(mirrored([3, 1], { at: [5, 7], along: [1, 0] })).toEqual([3, 13]);
    expect(centreOf([[0, 0], [10, 4], [2, 2]])).toEqual([5, 2]);
  });
  it("moves points in place", () => {
    expect(mirror(points, { points: ["A", "C"], links: [] }, { at: [50, 0], along: [0, 1] })).toEqual({ kind: "mirror", places: { A: [100, 0], C: [0, 40] } });
  });
});
