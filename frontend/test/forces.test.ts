import { describe, expect, it } from "vitest";
import { cornersOf } from "../src/force_polygon";
import { forcesOf, forcesOn, loadedLinks } from "../src/forces";
import type { MotionView } from "../src/motion";

/** A rod between a crank and a block at two pins, and three links at a third. */
function view(): MotionView {
  const column = (name: string, ...values: number[]): object => ({ name, unit: "N", values: Float64Array.from(values) });
  const reaction = (point: number, on: string, by: string, stem: string): object => ({ point, on, by, x: `${stem}.x`, y: `${stem}.y` });
  return {
    data: {
      reactions: [
        reaction(0, "rod", "crank", "A.force"), reaction(1, "block", "rod", "B.force"), reaction(1, "", "", "B.load"),
        reaction(2, "arm", "rod", "C.force.arm"), reaction(2, "rod", "", "C.force.rod"),
      ],
    },
    points: ["A", "B", "C"].map((shown) => ({ shown })),
    series: [
      column("A.force.x", 3, 1), column("A.force.y", 4, 1), column("B.force.x", 2, 1), column("B.force.y", 1, 1),
      column("B.load.x", 0, 0), column("B.load.y", -9, -9), column("C.force.arm.x", 5, 1), column("C.force.arm.y", 6, 1),
      column("C.force.rod.x", -5, 1), column("C.force.rod.y", -6, 1),
    ],
  } as unknown as MotionView;
}

describe("forces of pins", () => {
  it("are named after their points, and after links where more than two share a pin", () => {
    expect(forcesOf(view()).map(({ name }) => name)).toEqual(["F(A)", "F(B)", "P(B)", "F(C, arm)", "F(C, rod)"]);
    expect(loadedLinks(view())).toEqual(["rod", "crank", "block", "arm"]);
  });

  it("act on both links of a pin in opposite directions", () => {
    const rod = forcesOn(view(), "rod");
    expect(rod.map(({ name }) => name)).toEqual(["F(A)", "−F(B)", "F(C, rod)"]);
    expect(rod.map(({ at }) => [...at(0)])).toEqual([[3, 4], [-2, -1], [-5, -6]]);
    expect(forcesOn(view(), "crank").map(({ at }) => [...at(0)])).toEqual([[-3, -4]]);
  });

  it("are drawn head to tail", () => {
    expect(cornersOf(forcesOn(view(), "rod"), 0)).toEqual([[0, 0], [3, 4], [1, 3], [-4, -3]]);
  });

  it("without columns are left out", () => {
    const bare = { ...view(), series: [] } as unknown as MotionView;
    expect(forcesOf(bare)).toEqual([]);
  });
});
