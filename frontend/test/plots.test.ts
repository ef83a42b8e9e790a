import { describe, expect, it } from "vitest";
import { ends, grouped, scale } from "../src/axes";
import { lineOverInput, lineThrough } from "../src/curve";
import { sameInput } from "../src/ghost";
import { MotionView } from "../src/motion";
import type { MotionData, PackedColumn } from "../src/page_data";
import { HODOGRAPH, panelOf, POLAR, type Wanted } from "../src/panel";
import { choicesOf, quantityOf, ratesOf, splitRate, TIME, type Plottable } from "../src/quantities";

function plain(values: readonly number[]): PackedColumn {
  const bytes = new Uint8Array(Float64Array.from(values).buffer);
  return { step: 1, order: -1, content: btoa(String.fromCharCode(...bytes)), gaps: [] };
}

const ROWS = 13;
const ANGLES = Array.from({ length: ROWS }, (_, k) => 30 * k);
const RADIANS = ANGLES.map((angle) => (angle * Math.PI) / 180);
const of = (f: (t: number) => number): PackedColumn => plain(RADIANS.map(f));

/** A crank of length 10 at 2 rad/s and a link that swings by 20 degrees. */
function motion(changes: Partial<MotionData> = {}): MotionView {
  const every = plain(ANGLES.map(() => 1));
  const none = plain(ANGLES.map(() => 0));
  const data: MotionData = {
    name: "motion", summary: "", rows: ROWS, order: plain(ANGLES.map((_, k) => k)), closed: false,
    speed: 2, backwards: false, turns: [], frames: [], parts: [], vectors: [], driven: [], limits: [], numbers: [], answers: [], reactions: [], view: [-10, -10, 10, 10],
    columns: [
      { name: "crank", shown: "crank", unit: "deg", group: "input", values: plain(ANGLES), first: null, first_unit: "", band: [] },
      { name: "rocker", shown: "rocker", unit: "deg", group: "unknown", values: of((t) => 20 * Math.sin(t)), first: of(Math.cos), first_unit: "rad/rad", band: [] },
      { name: "A.transmission", shown: "A.transmission", unit: "deg", group: "derived", values: of((t) => 90 + 60 * Math.sin(t)), first: null, first_unit: "rad/rad", band: [40, 140] },
    ],
    points: [{
      name: "A", shown: "A", drawn: true, x: of((t) => 10 * Math.cos(t)), y: of((t) => 10 * Math.sin(t)),
      dx: of((t) => -10 * Math.sin(t)), dy: of((t) => 10 * Math.cos(t)),
      ddx: of((t) => -10 * Math.cos(t)), ddy: of((t) => -10 * Math.sin(t)),
    }],
    evidence: {
      found: every, status: none, status_texts: [""], certification: none, certification_texts: [""], certified: every,
      residual_log10: none, radius_log10: none, iterations: none, branch: none, branch_names: ["one"],
    },
    ...changes,
  };
  return new MotionView(data, { length_unit: "mm", derivative_unit: "rad" });
}

const wanted = (view: MotionView, names: readonly string[], over = ""): Wanted => ({
  view, past: null, names, over, width: 400, height: 200, before: null,
});

describe("a design before that did not move", () => {
  it("is no curve of a chart", () => {
    const panel = panelOf({ ...wanted(motion(), ["rocker"]), past: motion({ columns: [] }) });
    expect(panel.lines[0]).toMatch(/^M/);
    expect(panel.past).toEqual([""]);
  });
});

describe("rates of points", () => {
  it("are known to have been read, also where they were not sent", () => {
    const view = motion();
    expect(quantityOf(view, "A.y")!.values[1]).toBe(view.points[0]!.y[1]);
    expect(view.ratesRead).toBe(false);
    const [point] = motion().data.points;
    const none: PackedColumn = { step: 1, order: 0, content: "", gaps: [] };
    const bare = motion({ points: [{ ...point!, dx: none, dy: none, ddx: none, ddy: none }] });
    expect([...bare.points[0]!.dx]).toEqual(Array(ROWS).fill(NaN));
    expect(bare.ratesRead).toBe(true);
  });
});

describe("quantities of a page", () => {
  const view = motion();

  it("separates a rate from a name", () => {
    expect(splitRate("B.x.d2")).toEqual(["B.x", "d2"]);
    expect(splitRate("B.transmission")).toEqual(["B.transmission", ""]);
    expect(splitRate("velocity")).toEqual(["velocity", ""]);
  });

  it("gives rates with respect to the input and the time, with their units", () => {
    const at = (name: string): [number, string] => [quantityOf(view, name)!.values[0]!, quantityOf(view, name)!.unit];
    expect(at("rocker.d1")).toEqual([1, "rad/rad"]);
    expect(at("rocker.velocity")).toEqual([2, "rad/s"]);
    expect(at("A.x.d2")).toEqual([-10, "mm/rad²"]);
    expect(at("A.velocity")).toEqual([20, "mm/s"]);
    expect(at("A.acceleration")).toEqual([40, "mm/s²"]);
    expect(quantityOf(view, "A.acceleration")!.shown).toBe("|acceleration of A|");
  });

  it("has no second derivative of an unknown and none of a name that does not exist", () => {
    expect(quantityOf(view, "rocker.d2")).toBeNull();
    expect(quantityOf(view, "nobody.x")).toBeNull();
    expect(ratesOf(view, "rocker")).toEqual(["", "d1", "velocity"]);
    expect(ratesOf(view, "rocker", 2)).toEqual(["", "d1", "d2", "velocity", "acceleration"]);
    expect(ratesOf(view, "A", 2)).toEqual(["d1", "d2", "velocity", "acceleration"]);
  });

  it("offers columns, coordinates and points, not the input", () => {
    expect(choicesOf(view).map((one) => one.name)).toEqual(["rocker", "A.transmission", "A.x", "A.y", "A"]);
  });

  it("has a time at constant speed, and none where the input reverses or has no speed", () => {
    expect(quantityOf(view, TIME)!.values[12]).toBeCloseTo(Math.PI, 12);
    expect(quantityOf(motion({ speed: 0 }), TIME)).toBeNull();
    const evidence = { ...motion().data.evidence, branch_names: ["one", "two"] };
    expect(quantityOf(motion({ evidence }), TIME)).toBeNull();
    expect(quantityOf(motion({ speed: 0 }), "rocker.velocity")).toBeNull();
  });
});

describe("scales", () => {
  const curve = (unit: string, size: number): Plottable => ({ name: "", shown: "", unit, values: [0, size], rate: false, band: [] });

  it("are shared by equal units and similar ranges", () => {
    const curves = [curve("deg", 90), curve("mm", 5), curve("deg", 60), curve("mm", 500), curve("mm", 0)];
    expect(grouped(curves, [0, 1])).toEqual([[0, 2], [1, 4], [3]]);
  });

  it("cut off the rate at a dead point, not a steady rate", () => {
    const steady = Array.from({ length: 21 }, (_, k) => k);
    expect(ends(steady, true)).toEqual([0, 20]);
    expect(ends([...steady, 1e6], false)).toEqual([0, 1e6]);
    expect(ends([...steady, 1e6], true)[1]).toBeLessThan(40);
    expect(ends([Number.NaN, 3, 4])).toEqual([3, 4]);
  });

  it("widen a level line", () => {
    const level = scale(5, 5, 0, 100);
    expect([level.low, level.high]).toEqual([4.5, 5.5]);
  });
});

describe("curves", () => {
  it("are interrupted where a rate has no value", () => {
    const view = motion();
    const x = view.input.values;
    const y = x.map((_, k) => (k === 5 ? Number.NaN : k));
    const path = lineOverInput(view, x, y, (a, b) => [a, b]);
    expect(path.match(/M/g)).toHaveLength(2);
  });

  it("are interrupted where an angle jumps by a turn", () => {
    const view = motion();
    const y = view.input.values.map((_, k) => (k < 6 ? k : k - 100));
    expect(lineThrough(view, [y], (row) => [row, y[row]!]).match(/M/g)).toHaveLength(2);
  });
});

describe("panels", () => {
  const view = motion();

  it("have one scale for each unit", () => {
    expect(panelOf(wanted(view, ["rocker", "A.x", "A.y"])).extents).toHaveLength(2);
    expect(panelOf(wanted(view, ["rocker", "A.transmission"])).extents).toHaveLength(1);
  });

  it("draw a crank over its angle around a circle and as a circle of velocities", () => {
    const round = panelOf(wanted(view, ["A.velocity"], POLAR));
    const radius = (row: number): number => Math.hypot(round.at(0, row)[0] - 200, round.at(0, row)[1] - 100);
    expect(radius(4)).toBeCloseTo(radius(0), 9);
    expect(round.at(0, 3)[1]).toBeLessThan(100); // at a quarter turn the radius points up
    const tips = panelOf(wanted(view, ["A.velocity"], HODOGRAPH));
    const [x0, y0] = tips.at(0, 0);
    const [x6, y6] = tips.at(0, 6);
    expect(x0).toBeCloseTo(x6, 9); // velocities at 0 and 180° are vertical and opposite
    expect(y0).toBeLessThan(y6);
  });

  it("keep their scales while a design is dragged, and contain the design before", () => {
    const larger = motion({ points: motion().data.points.map((point) => ({ ...point, x: of((t) => 40 * Math.cos(t)) })) });
    const before = panelOf(wanted(larger, ["A.x"]));
    const after = panelOf({ ...wanted(view, ["A.x"]), before });
    expect(after.extents).toEqual(before.extents);
    const compared = panelOf({ ...wanted(view, ["A.x"]), past: larger });
    expect(compared.past).toHaveLength(1);
    expect(compared.extents[0]![1]).toBeGreaterThan(40);
  });

  it("show a quantity that is not there as nothing", () => {
    const panel = panelOf(wanted(view, ["rocker.d2"]));
    expect(panel.lines).toEqual([""]);
  });
});

describe("the design before", () => {
  it("stands at the same input", () => {
    expect(sameInput(motion(), 61, 0)).toBe(2);
    expect(sameInput(motion(), 360, 12)).toBe(12);
  });
});
