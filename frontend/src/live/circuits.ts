// The panel of circuits: all motions that the mechanism can make without disassembly.

import type { BranchFound, CircuitFound, CircuitsFound } from "../messages";
import { measured } from "../numbers";
import { html } from "../svg";
import type { PageData } from "../page_data";
import type { Desk } from "./asking";

export class CircuitsPanel {
  readonly element = html("div", { class: "lw-circuits" });
  private readonly state: HTMLElement;
  private readonly list: HTMLElement;
  private readonly back: HTMLButtonElement;
  private found: CircuitsFound | null = null;
  private on = false;
  private chosen = "";

  /** `show` draws the motion of a circuit; `null` that of the file. */
  constructor(
    private readonly desk: Desk,
    private readonly show: (page: PageData | null) => void,
  ) {
    html("p", { class: "lw-lead" }, this.element, "A circuit contains all positions that can be reached without taking the mechanism apart.");
    const row = html("div", { class: "lw-newton-row" }, this.element);
    const find = html("button", { type: "button" }, row, "List again");
    find.addEventListener("click", () => this.find());
    this.back = html("button", { type: "button", hidden: "" }, row, "Back to the motion of the file");
    this.back.addEventListener("click", () => this.choose(null));
    this.state = html("p", { class: "lw-summary", role: "status" }, this.element);
    this.list = html("div", { class: "lw-circuit-list" }, this.element);
  }

  /** Whether a circuit other than the motion of the file is drawn. */
  get elsewhere(): boolean {
    return this.chosen !== "";
  }

  /** The motion of the file is drawn again. */
  left(): void {
    this.mark("");
  }

  shown(on: boolean): void {
    this.on = on;
    if (on && this.found === null) this.find();
  }

  /** The file has changed: the list is outdated. */
  renew(): void {
    this.found = null;
    this.mark("");
    this.list.replaceChildren();
    this.state.textContent = this.on ? "The mechanism has changed." : "";
  }

  told(found: CircuitsFound): void {
    this.found = found;
    const count = found.circuits.length;
    this.state.textContent = `${count} ${count === 1 ? "circuit" : "circuits"}: ${found.message}`;
    this.list.replaceChildren();
    for (const circuit of found.circuits) this.list.append(this.entry(circuit, found));
    this.mark("");
  }

  private find(): void {
    this.state.textContent = "Finding all circuits …";
    this.desk.ask({ kind: "list_circuits" });
  }

  private entry(circuit: CircuitFound, found: CircuitsFound): HTMLElement {
    const box = html("section", { class: "lw-circuit", "data-circuit": circuit.name });
    const head = html("div", { class: "lw-newton-row" }, box);
    html("strong", {}, head, circuit.name);
    if (circuit.current) html("span", { class: "lw-summary" }, head, "contains the motion of the file");
    const drawn = found.page?.motions.some((motion) => motion.name === circuit.name) ?? false;
    const look = html("button", { type: "button", class: "lw-look" }, head, "Show");
    look.disabled = !drawn;
    look.addEventListener("click", () => this.choose(circuit));
    const list = html("ul", {}, box);
    html("li", {}, list, told(circuit, found));
    for (const limit of circuit.limits) html("li", {}, list, `${limit.what} at ${limit.sentence}`);
    for (const branch of circuit.branches) this.branch(branch, circuit, found, list);
    return box;
  }

  private branch(branch: BranchFound, circuit: CircuitFound, found: CircuitsFound, list: Element): void {
    const line = html("li", {}, list, `${branch.name.replace(`${circuit.name} `, "")}: ${range(branch.input_range, found)} `);
    const start = html("button", { type: "button", class: "lw-small" }, line, "Start here");
    start.title = `Write configuration = "${branch.start}" into the file`;
    start.addEventListener("click", () => this.desk.ask({ kind: "choose_configuration", name: branch.start }));
  }

  private choose(circuit: CircuitFound | null): void {
    const page = this.found?.page ?? null;
    this.mark(circuit?.name ?? "");
    if (circuit === null || page === null) this.show(null);
    else this.show({ ...page, motions: page.motions.filter((motion) => motion.name === circuit.name) });
  }

  private mark(name: string): void {
    this.chosen = name;
    this.back.hidden = name === "";
    for (const box of this.list.querySelectorAll<HTMLElement>(".lw-circuit")) {
      box.querySelector(".lw-look")!.setAttribute("aria-pressed", String(box.dataset.circuit === name));
    }
  }
}

function range([low, high]: readonly [number, number], found: CircuitsFound): string {
  return `${measured(low, found.input_unit)} to ${measured(high, found.input_unit)}`;
}

/** The course of a circuit in words. */
function told(circuit: CircuitFound, found: CircuitsFound): string {
  const reach = range(circuit.input_range, found);
  const proof = circuit.certified ? "proved" : "not proved";
  if (circuit.turns === 0) return `${found.input} moves from ${reach} and reverses; ${circuit.end}, ${proof}`;
  if (circuit.turns === null) return `${found.input} from ${reach}; ${circuit.end}, ${proof}`;
  const turns = Math.abs(circuit.turns);
  return `${found.input} turns fully; ${circuit.end} after ${turns} ${turns === 1 ? "turn" : "turns"}, ${proof}`;
}
