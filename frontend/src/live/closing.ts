// A mechanism that cannot be closed, in words, with changes that close it.

import { unitText } from "../chart";
import type { CannotClose, FileState, LiveRequest } from "../messages";
import { shortNumber, trimmed } from "../numbers";
import type { PageData } from "../page_data";

export interface Closing {
  readonly label: string;
  readonly title: string;
  readonly request: LiveRequest;
}

export function closing(event: CannotClose, file: FileState): { text: string; remedies: Closing[] } {
  const unitOf = (name: string): string => unitText(file.inputs.find((one) => one.name === name)?.unit ?? "");
  const printed = (name: string, value: number): string => `${name} = ${trimmed(shortNumber(value, 5))}${unitOf(name)}`;
  const gap = `${trimmed(shortNumber(event.gap, 4))} ${file.length_unit}`.trim();
  const lengths = Object.entries(event.remedies).map(([name, needed]): Closing => {
    const now = file.numbers.find((one) => one.name === name)?.value ?? needed;
    const value = Number((needed + 0.03 * (needed - now)).toPrecision(6)); // a little beyond where the loops just close
    return { label: `${name} = ${trimmed(shortNumber(value))}`, title: "Changing only this length closes the loops", request: { kind: "set_number", name, value } };
  });
  const elsewhere = Object.entries(event.elsewhere).map(([name, value]): Closing => ({
    label: `begin at ${printed(name, value)}`,
    title: "The loops close at this input: move the points of the sketch to that position",
    request: { kind: "assemble_at", at: event.elsewhere },
  }));
  const at = Object.entries(event.input).map(([name, value]) => printed(name, value));
  const where = at.length ? `At ${at.join(", ")} the loops` : "The loops";
  const there = elsewhere.length ? (lengths.length ? " Or:" : " The loops close elsewhere:") : "";
  const help = lengths.length ? " Any one of these changes closes the loops:" : there;
  return { text: `${where} cannot close: a gap of ${gap} remains.${help}`, remedies: [...lengths, ...elsewhere] };
}

/** A page without anything to draw. */
export function blank(file: FileState): PageData {
  const theme = { background: "#ffffff", ink: "#1b1f24", faint: "#66707c", driven: "#c2410c", tones: [], styles: [] };
  const dark = { ...theme, background: "#14171b", ink: "#e6e9ed", faint: "#98a2ae" };
  const number = (value: number): { step: number; order: number; content: string; gaps: number[] } => ({ step: 1, order: -1, content: btoa(String.fromCharCode(...new Uint8Array(new Float64Array([value]).buffer))), gaps: [] });
  const [zero, one, none] = [number(0), number(1), number(NaN)];
  const evidence = {
    found: one, status: zero, status_texts: [""], certification: zero, certification_texts: [""], certified: zero,
    residual_log10: none, radius_log10: none, iterations: zero, branch: zero, branch_names: [""],
  };
  const motion = {
    name: file.title, summary: "", rows: 1, order: zero, closed: false, speed: 0, backwards: false, columns: [], points: [],
    turns: [], frames: [], parts: [], vectors: [], driven: [], evidence, limits: [], numbers: [], answers: [], reactions: [], view: [0, 0, 1, 1],
  };
  return {
    format: 1, title: file.title, length_unit: file.length_unit, derivative_unit: "", input_unit: "",
    view: [0, 0, 1, 1], stroke: 0.003, pin: 0.01, text: 0.03, motions: [motion], light: theme, dark, forces: [], force_unit: "", equations: [], questions: [],
  };
}
