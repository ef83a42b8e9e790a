// The panel of simulations: the start, progress, how the motion in time ended, and its events.

import type { FileState, FormOffered, SimulationEvent, SimulationFound } from "../messages";
import { shortNumber, trimmed } from "../numbers";
import type { PageData } from "../page_data";
import { html, put } from "../svg";
import type { Desk } from "./asking";
import { typed } from "./ranges";

/** The largest number of listed events. */
const LISTED = 200;

interface Hooks {
  /** Draw the simulation from its start, or the motion of the file again. */
  readonly show: (page: PageData | null) => void;
  /** The same simulation with other quantities. */
  readonly update: (page: PageData) => void;
  readonly goToRow: (row: number) => void;
  /** Open a form of the page. */
  readonly form: (name: string) => void;
}

export class SimulatePanel {
  readonly element = html("div", { class: "lw-simulate" });
  private readonly form: HTMLFormElement;
  private readonly starts: HTMLElement;
  private readonly fields: Readonly<Record<"until" | "start_speed" | "step", HTMLInputElement>>;
  private readonly straight: HTMLSelectElement;
  private readonly run: HTMLButtonElement;
  private readonly cancel: HTMLButtonElement;
  private readonly progress: HTMLProgressElement;
  private readonly state: HTMLElement;
  private readonly choices: HTMLElement;
  private readonly csv: HTMLButtonElement;
  private readonly again: HTMLButtonElement;
  private readonly back: HTMLButtonElement;
  private readonly list: HTMLElement;
  private found: SimulationFound | null = null;
  private running = false;
  private drawn = false;

  constructor(
    private readonly desk: Desk,
    private readonly hooks: Hooks,
  ) {
    html("p", { class: "lw-lead" }, this.element, "Inputs without a law are free: masses, loads, springs, a motor and stops move the mechanism from its start.");
    this.form = html("form", { class: "lw-form", "aria-label": "Simulation" }, this.element);
    const field = (label: string, value: string, placeholder = ""): HTMLInputElement => {
      const input = html("input", { type: "text", autocomplete: "off", spellcheck: "false", placeholder }, html("label", {}, this.form, label));
      input.value = value;
      return input;
    };
    const until = field("Until [s]", "2");
    const speed = field("Start speed", "", "0, 60 rad/s");
    this.starts = html("span", { class: "lw-starts" }, this.form);
    this.straight = html("select", {}, html("label", {}, this.form, "At change points"));
    html("option", { value: "stop" }, this.straight, "stop");
    html("option", { value: "straight" }, this.straight, "go straight on");
    this.fields = { until, start_speed: speed, step: field("A row every [s]", "", "automatic") };
    const row = html("div", { class: "lw-newton-row lw-wide" }, this.form);
    this.run = html("button", { type: "submit", class: "lw-run" }, row, "Simulate");
    this.cancel = html("button", { type: "button", hidden: "" }, row, "Cancel");
    this.progress = html("progress", { max: 1, hidden: "", "aria-label": "Progress of the simulation" }, row);
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.start();
    });
    this.cancel.addEventListener("click", () => this.desk.background({ kind: "cancel" }));
    this.state = html("p", { class: "lw-summary", role: "status" }, this.element);
    this.choices = html("div", { class: "lw-newton-row" }, this.element);
    const after = html("div", { class: "lw-newton-row" }, this.element);
    this.csv = html("button", { type: "button", hidden: "" }, after, "Save as CSV");
    this.csv.addEventListener("click", () => this.desk.ask({ kind: "export", format: "csv", simulated: true }));
    this.again = html("button", { type: "button", hidden: "" }, after, "Show the simulation");
    this.again.addEventListener("click", () => this.look(true));
    this.back = html("button", { type: "button", hidden: "" }, after, "Back to the motion of the file");
    this.back.addEventListener("click", () => this.look(false));
    this.list = html("div", { class: "lw-events" }, this.element);
  }

  /** Whether the simulation is drawn. */
  get elsewhere(): boolean {
    return this.drawn;
  }

  /** The motion of the file is drawn. */
  left(): void {
    this.mark(false);
  }

  /** Another state of the file: a simulation is outdated. */
  renew(file: FileState): void {
    this.inputs(file);
    if (this.found === null) return;
    this.clear();
    this.state.textContent = "The mechanism has changed: simulate again.";
  }

  /** Choose the first field of the start. */
  focus(): void {
    this.fields.until.focus();
  }

  /** The finished fraction of the simulation under way. */
  working(fraction: number): void {
    if (!this.running) return;
    this.progress.value = fraction;
    this.state.textContent = `Simulating: ${Math.floor(100 * fraction)} %`;
  }

  /** A request was refused: if it was a simulation, it is over. */
  refused(message: string): void {
    if (!this.running) return;
    this.ended();
    this.state.textContent = message[0]!.toUpperCase() + message.slice(1);
  }

  told(found: SimulationFound): void {
    if (!this.running) {
      if (found.page && this.drawn) this.hooks.update(found.page);
      return;
    }
    this.clear();
    this.state.textContent = told(found);
    put(this.state, { "data-complete": String(found.complete) });
    for (const one of found.forms) this.offer(one);
    if (found.page === null) {
      this.hooks.show(null);
      return;
    }
    this.found = found;
    this.csv.hidden = false;
    this.events(found.events);
    this.look(true);
  }

  private start(): void {
    const { until, start_speed, step } = this.fields;
    const at: Record<string, number | string> = {};
    const speeds: Record<string, number | string> = {};
    for (const input of this.starts.querySelectorAll("input")) {
      if (input.value.trim()) (input.dataset.input ? at : speeds)[(input.dataset.input ?? input.dataset.speed)!] = typed(input.value);
    }
    const several = this.fields.start_speed.parentElement!.hidden;
    this.clear();
    this.begun();
    this.desk.ask({
      kind: "simulate",
      until: typed(until.value),
      ...(several && Object.keys(speeds).length ? { start_speeds: speeds } : {}),
      ...(!several && start_speed.value.trim() ? { start_speed: typed(start_speed.value) } : {}),
      ...(step.value.trim() ? { step: typed(step.value) } : {}),
      ...(Object.keys(at).length ? { at } : {}),
      change_points: this.straight.value,
    });
  }

  private begun(): void {
    this.running = true;
    this.state.textContent = "Simulating …";
    this.run.disabled = true;
    this.progress.removeAttribute("value");
    this.cancel.hidden = this.progress.hidden = false;
  }

  private ended(): void {
    const focused = document.activeElement === this.cancel;
    this.running = false;
    this.run.disabled = false;
    this.cancel.hidden = this.progress.hidden = true;
    if (focused) this.run.focus();
  }

  private clear(): void {
    this.ended();
    this.found = null;
    this.state.removeAttribute("data-complete");
    this.choices.replaceChildren();
    this.list.replaceChildren();
    this.csv.hidden = true;
    this.mark(false);
  }

  /** A start for every input of the file, and of several their start speeds. */
  private inputs(file: FileState): void {
    const wanted = file.inputs.map(({ name, unit }) => `${name} ${unit}`).join("\n");
    if (this.starts.dataset.made === wanted) return;
    this.starts.dataset.made = wanted;
    this.starts.replaceChildren();
    const several = file.inputs.length > 1;
    this.fields.start_speed.parentElement!.hidden = several;
    for (const { name, unit } of file.inputs) {
      const label = html("label", {}, this.starts, `Start of ${name}${unit ? ` [${unit}]` : ""}`);
      html("input", { type: "text", autocomplete: "off", spellcheck: "false", placeholder: "as drawn", "data-input": name }, label);
      if (!several) continue;
      const speed = html("label", {}, this.starts, `Start speed of ${name}`);
      html("input", { type: "text", autocomplete: "off", spellcheck: "false", placeholder: "0, 60 rad/s", "data-speed": name }, speed);
    }
  }

  private offer({ form, label }: FormOffered): void {
    const button = html("button", { type: "button", "data-form": form }, this.choices, label);
    button.addEventListener("click", () => (form === "start" ? this.focus() : this.hooks.form(form)));
  }

  private look(on: boolean): void {
    const page = this.found?.page ?? null;
    if (page === null) return;
    this.mark(on);
    this.hooks.show(on ? page : null);
  }

  private mark(on: boolean): void {
    this.drawn = on;
    this.back.hidden = !on;
    this.again.hidden = on || this.found === null;
  }

  private events(events: readonly SimulationEvent[]): void {
    if (!events.length) return;
    html("h2", {}, this.list, events.length === 1 ? "1 event" : `${events.length} events`);
    const list = html("ol", {}, this.list);
    for (const { row, t, text } of events.slice(0, LISTED)) {
      const button = html("button", { type: "button", class: "lw-small" }, html("li", {}, list), `${trimmed(shortNumber(t, 6, 1e-12))} s: ${text}`);
      button.addEventListener("click", () => {
        this.look(true);
        this.hooks.goToRow(row);
      });
    }
    if (events.length > LISTED) html("p", { class: "lw-lead" }, this.list, `and ${events.length - LISTED} more, all marked on the time line`);
  }
}

/** How a simulation ended. */
function told({ message, rows, certified, energy, page }: SimulationFound): string {
  if (page === null) return message.endsWith(".") ? message : `${message}.`;
  return [`${message}.`, `${rows} rows, ${certified} proved.`, ...(energy ? [`Energy ${energy}.`] : [])].join(" ");
}
