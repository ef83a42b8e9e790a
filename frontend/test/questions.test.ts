import { describe, expect, it } from "vitest";
import { right, told } from "../src/questions";

const lock = { known: true, values: [22.3316, 337.6684] };
const angle = { tolerance: 0.5, turn: 360, unit: "deg" };

describe("an answer", () => {
  it("is right within the tolerance of any of the values", () => {
    expect(right(angle, lock, "22.5")).toBe(true);
    expect(right(angle, lock, "338")).toBe(true);
    expect(right(angle, lock, "23")).toBe(false);
  });

  it("is the same a whole turn further, if it is an angle", () => {
    expect(right(angle, lock, "-22,3°")).toBe(true);
    expect(right(angle, lock, "−22.3 deg")).toBe(true);
    expect(right({ tolerance: 0.5, turn: 0 }, lock, "-22.3")).toBe(false);
  });

  it("may be that there is none", () => {
    const never = { known: true, values: [] };
    expect(right(angle, never, "None")).toBe(true);
    expect(right(angle, never, "0")).toBe(false);
    expect(right(angle, lock, "none")).toBe(false);
    expect(told(angle, never)).toBe("There is none.");
  });

  it("is no number, or not known: never right", () => {
    expect(right(angle, lock, "about 22")).toBe(false);
    expect(right(angle, lock, "")).toBe(false);
    expect(right(angle, { known: false, values: [] }, "none")).toBe(false);
    expect(told(angle, undefined)).toMatch(/not known/);
  });

  it("is told with its unit", () => {
    expect(told(angle, lock)).toBe("22.3316° or 337.668°");
  });
});
