// The page of a task: its canvas, its designs, and what they cost.

import { declareKeys, press, showKeys, type Command } from "../keys";
import { Shell } from "../live/shell";
import { Tabs } from "../live/tabs";
import type { Transport } from "../live/transport";
import type { DesignFound, LiveEvent, LiveRequest, TaskSolved, TaskState, TaskUnsolved } from "../messages";
import { html, say } from "../svg";
import { themeButton } from "../theme_button";
import { Cognates } from "./cognates";
import { called, DesignsTable, inOneLine, PATHS } from "./designs_table";
import { Pareto } from "./pareto";
import { PositionPlayer } from "./position_player";
import { TaskCanvas } from "./task_canvas";
import { TaskForm } from "./task_form";
import { TOOLS } from "./tools";

const ANSWERS: ReadonlySet<LiveEvent["kind"]> = new Set(["task_solved", "task_unsolved", "refused"]);
/** Long work: what it is called, and what its button does. */
const DOING = { search: "Searching for designs", nearest: "Comparing paths of the atlas", improve: "Improving the design" } as const;
/** More positions are met approximately: the best of a search that is ended are kept. */
const EXACT = 9;
const KINDS: Readonly<Record<string, string>> = { motion: "pose", path: "point", mixed: "position", improve: "point" };

export class TaskPage {
  private readonly root: HTMLElement;
  private readonly side: HTMLElement;
  private readonly title: HTMLElement;
  private readonly summary: HTMLElement;
  private readonly shell: Shell;
  private readonly canvas: TaskCanvas;
  private readonly player: PositionPlayer;
  private readonly chosen = html("div", { class: "lw-t-chosen" });
  private readonly open: HTMLButtonElement;
  private readonly improve: HTMLButtonElement;
  private readonly line: HTMLElement;
  private doing: keyof typeof DOING = "search";
  /** Long work that was asked for, which may wait for the end of a search. */
  private asked: { readonly id: number; readonly doing: keyof typeof DOING } | null = null;
  private readonly waiting = html("div", { class: "lw-t-waiting", role: "status", hidden: "" });
  private readonly table: DesignsTable;
  private readonly pareto: Pareto;
  private readonly cognates: Cognates;
  private readonly form: TaskForm;
  private readonly tabs: Tabs;
  private task: TaskState | null = null;
  private solved: TaskSolved | null = null;
  private design: DesignFound | null = null;

  constructor(
    private readonly element: HTMLElement,
    transport: Transport,
  ) {
    this.root = html("div", { class: "lw lw-full lw-task", tabindex: -1 }, element);
    this.shell = new Shell(() => transport, { file: () => this.task, restore: () => this.restore(), answers: ANSWERS });
    const head = html("header", { class: "lw-head" }, this.root);
    this.title = html("h1", {}, head);
    this.summary = html("p", { class: "lw-summary" }, head);
    head.append(this.shell.bar.element);
    const corner = html("div", { class: "lw-corner" }, head);
    themeButton(corner, this.root);
    const keys = html("button", { type: "button", class: "lw-keys-button", "aria-label": "Keys", title: "All keys (?)" }, corner, "?");
    keys.addEventListener("click", () => showKeys(this.root));
    const stage = html("section", { class: "lw-stage", "aria-label": "Canvas" }, this.root);
    this.canvas = new TaskCanvas({ ask: (request) => this.ask(request), drag: (request) => this.shell.drag(request), picked: (thing) => this.form.mark(thing) });
    this.player = new PositionPlayer((row, at) => this.canvas.stand(row, at));
    stage.append(this.canvas.element, this.waiting, this.shell.notices.element, this.player.element);
    this.open = html("button", { type: "button", class: "lw-t-open" }, this.chosen, "Open as mechanism");
    this.improve = html("button", { type: "button", title: "Change its numbers so that the positions or goals are met better" }, this.chosen, "Improve");
    this.improve.addEventListener("click", () => this.work("improve", this.design && { kind: "improve_design", design: this.design.design.index }));
    this.line = html("p", {}, this.chosen);
    this.open.addEventListener("click", () => this.design && this.ask({ kind: "open_design", design: this.design.design.index }));
    const choose = (index: number): void => this.ask({ kind: "show_design", design: index });
    this.table = new DesignsTable(choose, () => this.work("nearest", { kind: "find_nearest" }));
    this.pareto = new Pareto(choose);
    this.cognates = new Cognates(choose);
    this.form = new TaskForm((request) => this.ask(request), (thing) => this.canvas.pick(thing));
    this.tabs = new Tabs([
      { title: "Designs", element: this.table.element, shown: (on) => on && this.mark() },
      { title: "Trade-off", element: this.pareto.element },
      { title: "Cognates", element: this.cognates.element, shown: (on) => on && this.askCognates() },
      { title: "Task", element: this.form.element },
    ]);
    this.side = html("section", { class: "lw-side", "aria-label": "Designs" }, this.root);
    this.side.append(this.chosen, this.tabs.element);
    document.addEventListener("keydown", (event) => this.key(event));
    this.chosen.hidden = this.player.element.hidden = true;
  }

  told(event: LiveEvent): void {
    switch (event.kind) {
      case "task_state":
        this.state(event);
        break;
      case "task_solved":
        this.solve(event);
        break;
      case "task_unsolved":
        this.unsolved(event);
        break;
      case "designs_suggested":
        this.table.suggest(event);
        if (this.task) this.pareto.show(this.task, this.table.designs);
        this.mark();
        break;
      case "design_found":
        this.look(event);
        break;
      case "cognates_found":
        this.cognates.show(event);
        break;
      case "working":
        this.working(event.fraction, event.answers);
        break;
    }
    if (event.kind !== "working" && event.answers !== null) {
      this.waiting.hidden = true;
    }
    this.shell.told(event);
  }

  lost(message: string): void {
    this.player.play(false);
    this.waiting.hidden = true;
    this.shell.lost(message, this.element, this.side);
  }

  /** Ask for long work. */
  private work(doing: keyof typeof DOING, request: LiveRequest | null): void {
    if (!request) return;
    this.asked = { id: this.shell.ask(request), doing };
    if (this.waiting.hidden) this.working(0, this.asked.id);
  }

  private ask(request: LiveRequest): void {
    this.shell.ask(request);
  }

  private state(task: TaskState): void {
    if (this.task?.file !== task.file) this.another(task);
    declareKeys("Task", this.commands);
    this.task = task;
    this.shell.bar.show(task);
    say(this.title, task.title);
    this.canvas.show(task);
    this.form.show(task);
    this.table.offer(task);
    if (!this.canvas.dragging) this.stale(true);
    this.count();
  }

  private another(task: TaskState): void {
    this.solved = this.design = null;
    this.table.show(task, null);
    this.pareto.show(task, []);
    this.describe();
    this.canvas.solve(null);
    this.player.show(null);
    this.cognates.show(null);
  }

  /** Designs of the task before are pale until those of the present one are found. */
  private stale(on: boolean): void {
    this.root.classList.toggle("lw-t-stale", on);
  }

  private solve(solved: TaskSolved): void {
    this.waiting.hidden = true;
    this.stale(false);
    this.solved = solved;
    this.design = solved.chosen;
    this.canvas.solve(solved);
    this.player.show(solved.chosen, solved.live);
    this.shell.notices.calm();
    this.describe();
    this.root.dataset.live = String(solved.live);
    this.root.dataset.solved = String(Number(this.root.dataset.solved ?? 0) + 1);
    if (solved.live) return;
    this.table.show(this.task!, solved);
    this.pareto.show(this.task!, this.table.designs);
    this.mark();
    this.count();
    if (this.tabs.chosen === this.tabs.indexOf("Cognates")) this.askCognates();
  }

  private unsolved(event: TaskUnsolved): void {
    this.waiting.hidden = true;
    if (event.slow) {
      this.stale(true);
      return;
    }
    this.solved = this.design = null;
    this.canvas.solve(null);
    this.player.show(null);
    this.describe();
    this.stale(false);
    const lines = event.problems.map(({ line, key, message }) => [[line === null ? "" : `line ${line}`, key].filter(Boolean).join(", "), message].filter(Boolean).join(": "));
    const text = [event.message, ...lines.slice(0, 3)].join(" ");
    const choices: [string, string, () => void][] = event.ended ? [["Solve", "Search for designs again", () => this.ask({ kind: "solve_task" })]] : [];
    this.shell.notices.open(text, choices);
    this.root.dataset.solved = String(Number(this.root.dataset.solved ?? 0) + 1);
    if (event.live) return;
    this.table.show(this.task!, null, text);
    this.pareto.show(this.task!, this.table.designs);
    this.cognates.show(null);
    this.count();
  }

  /** A search that takes long has a button to end it. */
  private working(fraction: number, answers: number | null): void {
    const doing = this.asked?.id === answers ? this.asked.doing : "search";
    if (this.waiting.hidden || doing !== this.doing) {
      this.doing = doing;
      this.waiting.replaceChildren();
      html("span", {}, this.waiting);
      const { task } = this;
      const keeps = this.doing === "improve" || (this.doing === "search" && task !== null && (task.task === "improve" || (task.task === "path" && task.positions.length > EXACT)));
      const end = html("button", { type: "button" }, this.waiting, keeps ? "Stop and keep the best" : this.doing === "search" ? "End the search" : "Stop");
      end.addEventListener("click", () => this.shell.background({ kind: "cancel" }));
      this.waiting.hidden = false;
    }
    say(this.waiting.querySelector("span")!, `${DOING[this.doing]}: ${Math.round(100 * fraction)} %`);
  }

  private look(found: DesignFound): void {
    this.design = found;
    this.canvas.look(found);
    this.player.show(found);
    this.describe();
    this.mark();
    if (this.tabs.chosen === this.tabs.indexOf("Cognates")) this.askCognates();
  }

  private mark(): void {
    const index = this.design?.design.index ?? -1;
    this.table.mark(index);
    this.pareto.mark(index);
  }

  private askCognates(): void {
    const of = ["path", "mixed"].includes(this.task!.task);
    if (this.design && !this.design.design.origin && of) this.shell.background({ kind: "show_cognates", design: this.design.design.index });
    else this.cognates.show(null, of ? undefined : "Only four-bars found for a path have cognates: these share the path of a point, but neither poses nor functions.");
  }

  /** The chosen design in words. */
  private describe(): void {
    const design = this.design?.design;
    this.chosen.hidden = !design;
    if (!design) return;
    const doubt = design.reason ? `${design.reason.slice(0, 1).toUpperCase()}${design.reason.slice(1)}` : design.remark;
    say(this.line, `${called(design)}: ${inOneLine(design, this.task!)}${doubt && `. ${doubt}`}`);
    this.chosen.classList.toggle("lw-t-refused", !design.sound);
    this.improve.hidden = !PATHS.includes(this.task!.task);
  }

  private count(): void {
    const { task } = this;
    if (!task) return;
    const solved = this.root.classList.contains("lw-t-stale") ? null : this.solved;
    const word = KINDS[task.task];
    const count = task.positions.length;
    const given = task.task === "improve" && !count ? "goals of a mechanism" : word ? `${count} ${word}${count === 1 ? "" : "s"}` : "function";
    say(this.summary, solved ? `${given} · ${solved.count} design${solved.count === 1 ? "" : "s"}, ${solved.sound} without defects` : given);
    this.summary.title = solved ? `${solved.solutions}; ${solved.message}` : "";
  }

  /** Show the task as it is, where a change of it was refused. */
  private restore(): void {
    if (!this.task || this.canvas.dragging) return;
    this.canvas.show(this.task);
    this.form.show(this.task);
  }

  private readonly commands: readonly Command[] = [
    { keys: [" "], does: "Play the chosen design, or stand still", act: () => this.player.play() },
    { keys: ["ArrowRight", "ArrowLeft", "ArrowUp", "ArrowDown"], does: "Move what is picked, with Shift finely; else the next position", act: (event) => this.arrow(event) },
    { keys: [..."123456789"], does: "Go to this position", act: (event) => this.player.goTo(Number(event.key) - 1) },
    { keys: ["Delete", "Backspace"], does: "Remove what is picked", act: () => this.canvas.remove() },
    { keys: ["Escape"], does: "Pick nothing; the tool that moves", act: () => this.rest() },
    { keys: ["+", "="], does: "Zoom in", act: () => this.canvas.zoom(1.25) },
    { keys: ["-"], does: "Zoom out", act: () => this.canvas.zoom(0.8) },
    { keys: ["0"], does: "See the whole task", act: () => this.canvas.whole() },
    ...TOOLS.map(({ tool, name, key, does, of }): Command => ({ keys: [key], does: `${name}: ${does}`, when: () => of.includes(this.task?.task ?? ""), act: () => this.canvas.choose(tool) })),
    { keys: ["?"], does: "All keys", act: () => showKeys(this.root) },
  ];

  private arrow(event: KeyboardEvent): void {
    const [dx, dy] = ({ ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] } as const)[event.key as "ArrowUp"]!;
    if (!this.canvas.nudge(dx, dy, event.shiftKey)) this.player.step(dx + dy);
  }

  private rest(): void {
    this.canvas.pick(null);
    this.canvas.choose("move");
    this.root.focus();
  }

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    if (this.element.hidden || this.element.inert || target.closest("dialog")) return;
    if (target !== document.body && !this.root.contains(target)) return;
    if (target.matches("select, textarea, input") && event.key !== "Escape") return;
    if (event.key === " " && target.matches("button, summary")) return;
    press(this.commands, event);
  }
}
