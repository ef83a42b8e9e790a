import { describe, expect, it } from "vitest";
import { frameAt, searched, type Entry } from "../src/begin/library";

const entry = (name: string, title: string, family: string, purpose: string): Entry => ({ name, title, family, purpose });
const entries = [
  entry("shaper", "Crank shaper", "quick returns", "The tool returns faster than it cuts."),
  entry("watt", "Watt", "straight lines", "A coupler point follows nearly a straight line."),
  entry("press", "Knee press", "presses", "A large force near the end of the stroke; a straight ram."),
];
const names = (found: readonly Entry[]) => found.map((one) => one.name);

describe("the search of the library", () => {
  it("finds every word in any order and case", () => {
    expect(names(searched(entries, "LINE straight"))).toEqual(["watt"]);
    expect(names(searched(entries, "quick, tool"))).toEqual(["shaper"]);
    expect(searched(entries, "helicopter")).toEqual([]);
  });
  it("puts names before families, and families before purposes", () => {
    expect(names(searched(entries, "straight"))).toEqual(["watt", "press"]);
    expect(names(searched(entries, "press"))).toEqual(["press"]);
  });
  it("is all of it without a word", () => {
    expect(searched(entries, "  ")).toEqual(entries);
  });
});

describe("the frame of a picture", () => {
  it("goes around a closed motion", () => {
    expect([0, 1, 2, 2.99, 3].map((t) => frameAt(6, true, t))).toEqual([0, 2, 4, 5, 0]);
  });
  it("goes to and fro over an open one", () => {
    expect([0, 0.75, 1.5, 2.25, 3].map((t) => frameAt(5, false, t))).toEqual([0, 2, 4, 2, 0]);
  });
  it("stands where there is one", () => {
    expect(frameAt(1, true, 7)).toBe(0);
  });
});
