// Ranges and steps of sliders.

export interface Range {
  readonly low: number;
  readonly high: number;
  readonly step: number;
}

/** A round step: 1, 2 or 5 times a power of ten, not above `rough`. */
export function roundStep(rough: number): number {
  const power = 10 ** Math.floor(Math.log10(rough));
  const times = [5, 2, 1].find((one) => one * power <= rough * (1 + 1e-9)) ?? 1;
  return times * power;
}

/**
 * The range of a slider around a value, which is one of its steps: a length from a fifth to twice
 * its value, an angle by ± a quarter turn, a length of 0 by ± `size`.
 */
export function rangeAround(value: number, unit: string, size: number): Range {
  const quarter = unit === "deg" ? 90 : unit === "rad" ? Math.PI / 2 : 0;
  const [below, above] = quarter
    ? [quarter, quarter]
    : Math.abs(value) > 1e-9 * size
      ? [0.8 * Math.abs(value), Math.abs(value)]
      : [size, size];
  const step = roundStep((below + above) / 300);
  return {
    low: value - Math.floor(below / step + 1e-9) * step,
    high: value + Math.floor(above / step + 1e-9) * step,
    step,
  };
}

/** A number without the noise of binary fractions. */
export function clean(value: number): number {
  return Number(value.toPrecision(12));
}

/** User input: a number, or otherwise a formula. */
export function typed(text: string): number | string {
  const plain = text.trim().replace("\u2212", "-").replace(/°$/, "").replace(/^([-+]?\d+),(\d+)$/, "$1.$2");
  const number = Number(plain);
  return plain !== "" && Number.isFinite(number) ? number : plain;
}
