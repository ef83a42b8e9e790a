import { describe, expect, it } from "vitest";
import { degreeTicks, measured, powerOfTen, printedName, roundedDown, roundUp, shortNumber, ticks } from "../src/numbers";

describe("numbers", () => {
  it("has six digits, and a true minus sign", () => {
    expect(shortNumber(-121.4753912)).toBe("−121.475");
    expect(shortNumber(0.000512345678)).toBe("0.000512");
    expect(shortNumber(4e-7)).toBe("4.000·10⁻⁷");
  });

  it("shows rounding as 0, and nothing where there is no number", () => {
    expect(shortNumber(7.1e-15, 6, 1e-10)).toBe("0");
    expect(shortNumber(NaN)).toBe("–");
    expect(shortNumber(-1e-8, 6, 1e-10)).toBe("−1.000·10⁻⁸");
  });

  it("writes powers of ten as people do", () => {
    expect(powerOfTen(2.2e-14)).toBe("2.2·10⁻¹⁴");
    expect(powerOfTen(10 ** -400)).toBe("0");
  });

  it("prints names as they are drawn", () => {
    expect(["O2", "A", "θ12", "left stop", "B2C"].map(printedName)).toEqual(["O₂", "A", "θ₁₂", "left stop", "B2C"]);
  });

  it("measures with the unit", () => {
    expect(measured(60, "deg")).toBe("60°");
    expect(measured(-12.5, "mm")).toBe("−12.5000 mm");
    expect(measured(-1.4e-14, "deg")).toBe("0°");
  });

  it("rounds lower bounds down", () => {
    expect([40.0546, 44.9999, 9.9996, 45, 0.25057, 0].map((one) => roundedDown(one, 4))).toEqual([40.05, 44.99, 9.999, 45, 0.2505, 0]);
  });

  it("rounds up to short numbers", () => {
    expect([3.1, 0.0021, 70, 1, 8.5].map(roundUp).map((one) => Number(one.toPrecision(6)))).toEqual([4, 0.0025, 80, 1, 10]);
  });

  it("ticks at round numbers", () => {
    expect(ticks(-45, 45, 4)).toEqual([-40, -20, 0, 20, 40]);
    expect(ticks(219.99993838641867, 219.9999383864187, 4)).toEqual([219.99993838641867]);
    expect(degreeTicks(0, 360, 6)).toEqual([0, 60, 120, 180, 240, 300, 360]);
    expect(degreeTicks(10, 11, 4).length).toBeGreaterThan(2);
  });
});
