// The live page: drawing and player as on every page, with panels that edit the file.

import type { CannotClose, FileState, LiveEvent, LiveRequest, MotionFound, SketchShown } from "../messages";
import { mount, type Mounted, type PageData } from "../mount";
import { html, svg } from "../svg";
import type { Desk } from "./asking";
import { Build } from "./build";
import { CircuitsPanel } from "./circuits";
import { blank, closing } from "./closing";
import { Dimensions } from "./dimensions";
import { CanvasTools } from "./draw/canvas_tools";
import { Editor } from "./draw/editor";
import { Readiness } from "./draw/readiness";
import { ExportMenu } from "./export_menu";
import { firstHint } from "./first_hint";
import { ForceForms } from "./force_forms";
import { moved } from "./moved";
import { Newton } from "./newton";
import { Plots } from "./plots";
import { presentNewton } from "./presented";
import { Shell } from "./shell";
import { SimulatePanel } from "./simulate";
import { drawGaps } from "./schematic";
import { Tabs } from "./tabs";
import type { Connect, Transport } from "./transport";
import { Ways } from "./ways";

/** Events that answer a request, so that the next can be sent. */
const ANSWERS: ReadonlySet<LiveEvent["kind"]> = new Set(["motion_found", "cannot_close", "position_found", "sketch_shown", "newton_shown", "refused", "problems_found"]);

/** Widths of a blank sheet by unit; otherwise 240. */
const SHEETS: Readonly<Record<string, number>> = { mm: 240, cm: 24, m: 0.24, in: 10, ft: 1 };

/** Logarithm of the zoom at which symbols are drawn anew. */
const RESIZED = 0.2;

export class LivePage {
  private readonly connection: Transport;
  private readonly shell: Shell;
  private readonly dimensions: Dimensions;
  private readonly ways: Ways;
  private readonly newton: Newton;
  private readonly forms: ForceForms;
  private readonly build: Build;
  private readonly editor: Editor;
  private readonly canvas: CanvasTools;
  private readonly readiness: Readiness;
  private readonly circuits: CircuitsPanel;
  private readonly simulate: SimulatePanel;
  private readonly plots: Plots;
  private readonly exports: ExportMenu;
  /** The row at which the motion of the file was left for a circuit. */
  private left: number | null = null;
  /** The last motion of the file. */
  private found: MotionFound | null = null;
  private readonly tabs: Tabs;
  private file: FileState | null = null;
  private page: Mounted | null = null;
  /** The pages of the motion and of the sketch. */
  private moving: PageData | null = null;
  private sketched: PageData | null = null;
  /** Whether the page was made with plots. */
  private charted = false;
  private hint: Element | null = null;
  private readonly first = firstHint();
  /** The width of the sheet that was told last. */
  private width = 1;
  private resizing: ReturnType<typeof setTimeout> | undefined;
  /** Whether no row of the table has a position. */
  private rowless = false;

  constructor(private readonly element: HTMLElement, connect: Connect) {
    this.shell = new Shell(() => this.connection, {
      file: () => this.file,
      restore: () => this.restore(),
      answers: ANSWERS,
      dragged: (request) => this.withRates(request),
    });
    const desk = this.desk();
    this.dimensions = new Dimensions(desk);
    this.ways = new Ways(desk);
    this.newton = new Newton(desk);
    this.forms = new ForceForms(desk);
    this.build = new Build(desk, this.forms);
    this.editor = new Editor(desk, this.forms, {
      mode: (edited) => this.chosen(edited),
      viewed: () => this.viewed(),
      hint: (text) => this.hint && (this.hint.textContent = text),
    });
    this.canvas = new CanvasTools(desk, this.editor);
    this.readiness = new Readiness(
      desk,
      (chosen) => this.editor.select(chosen),
      () => this.editor.choose("move"),
    );
    this.plots = new Plots(desk);
    this.circuits = new CircuitsPanel(desk, (page) => this.look(page));
    this.simulate = new SimulatePanel(desk, {
      show: (page) => this.lookInTime(page),
      update: (page) => this.page?.update(page),
      goToRow: (row) => this.page?.goToRow(row),
      form: (name) => this.openForm(name),
    });
    this.exports = new ExportMenu(desk, () => this.row(), (text) => this.shell.notices.done(text));
    this.shell.bar.element.append(this.exports.element);
    this.tabs = new Tabs([
      { title: "Dimensions", element: this.dimensions.element },
      { title: "Configurations", element: this.ways.element, shown: (on) => this.ways.shown(on) },
      { title: "Circuits", element: this.circuits.element, shown: (on) => this.circuits.shown(on) },
      { title: "Simulate", element: this.simulate.element },
      { title: "Newton", element: this.newton.element, shown: (on) => this.newton.shown(on) },
      { title: "Build", element: this.build.element },
    ]);
    this.connection = connect({
      event: (event) => this.told(event),
      lost: (message) => this.lost(message),
    });
  }

  /** Intermediate answers have rates of points only while they are shown. */
  private withRates(request: LiveRequest): LiveRequest {
    const moves = request.kind === "set_number" || request.kind === "move_points";
    return moves ? { ...request, rates: this.page?.rates ?? true } : request;
  }

  private desk(): Desk {
    return {
      ask: (request) => this.shell.ask(request),
      background: (request) => void this.shell.background(request),
      latest: (request) => this.shell.drag(request),
      file: () => this.file!,
      here: () => this.here(),
      values: () => this.page?.values ?? {},
    };
  }

  /** The displayed row of the motion of the file. */
  private row(): number | null {
    const away = this.moving === null || this.editor.edited || this.circuits.elsewhere || this.simulate.elsewhere;
    return this.page === null || away ? null : this.page.row;
  }

  /** Draw the motion of a circuit, or that of the file. */
  private look(page: PageData | null): void {
    const shown = page ?? this.found?.page ?? null;
    if (shown === null || this.page === null) return;
    if (page !== null) this.left ??= this.page.row;
    this.page.update(shown);
    if (page === null && this.left !== null) this.page.goToRow(this.left);
    if (page === null) this.left = null;
  }

  /** Draw a simulation from its start, or the motion of the file. */
  private lookInTime(page: PageData | null): void {
    if (page !== null) {
      this.circuits.left();
      if (this.editor.edited) this.editor.choose("move");
      this.shell.notices.calm();
    }
    this.plots.simulated = page !== null;
    this.look(page);
    if (page === null) {
      if (this.found !== null) this.limits(this.found);
    } else if (this.page !== null) {
      this.page.goTo(0, 0);
      const [input] = this.file!.inputs;
      if (input) this.page.charts.plot(`${input.name}.velocity`);
      this.page.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
    }
    this.plots.turned();
  }

  /** Open a form that mends something, and choose its first field. */
  private openForm(name: string): void {
    this.tabs.choose(this.tabs.indexOf("Build"));
    this.build.open(name);
  }

  private here(): Record<string, number> {
    const inputs = this.file?.inputs ?? [];
    const values = this.page?.values ?? {};
    return Object.fromEntries(inputs.flatMap(({ name }) => (name in values ? [[name, values[name]!]] : [])));
  }

  private told(event: LiveEvent): void {
    switch (event.kind) {
      case "start_offered":
        this.shell.starting.offer(false);
        break;
      case "palette_shown":
        this.forms.kinds = event.forms;
        this.build.offer(event.parts);
        this.editor.offer(event.parts);
        break;
      case "file_state":
        this.state(event);
        break;
      case "motion_found":
        this.motion(event);
        break;
      case "sketch_shown":
        this.sketch(event);
        break;
      case "cannot_close":
        this.open(event);
        break;
      case "position_found":
        if (this.page === null || this.rowless || !this.file!.inputs.length) this.still(event.page, this.rowless ? "" : event.message);
        break;
      case "configurations_found":
        this.ways.show(event);
        break;
      case "circuits_found":
        this.circuits.told(event);
        break;
      case "simulation_found":
        this.simulate.told(event);
        break;
      case "quantities_listed":
        this.plots.told(event);
        break;
      case "exported":
        void this.exports.show(event);
        break;
      case "working":
        this.simulate.working(event.fraction);
        break;
      case "newton_shown":
        this.newton.show(event);
        break;
      case "point_moved":
        if (event.answers !== null && this.element.dataset.live !== "true") this.shell.notices.done(moved(event));
        break;
      case "refused":
        this.simulate.refused(event.message);
        break;
      case "design_opened":
        this.shell.bar.behind(event.task);
        break;
    }
    this.shell.told(event);
  }

  /** Show the numbers as they are, where a change of one was refused. */
  private restore(): void {
    if (this.file) this.dimensions.show(this.file);
  }

  private state(file: FileState): void {
    const before = this.file;
    if (before !== null && before.file !== file.file) this.another();
    const saved = before?.file === file.file && before.text === file.text && before.configuration === file.configuration;
    this.file = file;
    this.shell.bar.show(file);
    this.dimensions.show(file);
    this.build.show(file);
    if (!saved) {
      // a file that was only saved keeps what was found of it
      this.ways.renew();
      this.circuits.renew();
      this.simulate.renew(file);
    }
    this.plots.renew();
    this.newton.renew();
    this.editor.renew(file);
    this.readiness.show(file, this.editor.edited);
    this.page?.places.drawing.element.querySelector(".lw-gaps")?.remove();
  }

  /** Another file: nothing of the page stays. */
  private another(): void {
    this.shell.bar.behind("");
    this.page?.destroy();
    [this.page, this.moving, this.sketched, this.charted] = [null, null, null, false];
    this.editor.rest();
    this.readiness.rest();
  }

  private motion(found: MotionFound): void {
    if (!found.live) this.found = found;
    this.left = null;
    this.circuits.left();
    this.simulate.left();
    this.plots.simulated = false;
    this.rowless = found.page === null && found.missing === found.rows;
    this.moving = found.page;
    this.element.dataset.live = String(found.live);
    if (found.page !== null) {
      this.display(found.live);
      if (!found.live) this.plots.moved();
    } else if (found.missing < found.rows) {
      this.still(null, "This mechanism has no points to draw. The command linkwork sweep prints its numbers.");
    }
    this.limits(found);
    this.updated();
  }

  private limits(found: MotionFound): void {
    this.shell.notices.limits(found, this.file!.inputs[0]?.unit ?? "", (input) => this.page?.goToInput(input));
  }

  /** Count updates, for whoever waits for one. */
  private updated(): void {
    this.element.dataset.updates = String(Number(this.element.dataset.updates ?? 0) + 1);
  }

  /** Show the motion, or the sketch while it is edited or does not move. */
  private display(live = false): void {
    const page = this.editor.edited || this.moving === null ? (this.sketched ?? this.moving) : this.moving;
    if (page === null) return;
    const moves = page.motions[0]!.columns.length > 0;
    const fresh = this.page === null || (moves && !this.charted);
    if (fresh) this.begin(page);
    else this.page!.update(page, live && page === this.moving);
    this.charted ||= moves;
    this.editor.redraw(this.editor.edited ? this.moving : null);
  }

  private begin(data: PageData): void {
    const view = this.page && this.editor.edited ? this.page.places.drawing.window : null;
    this.page?.destroy();
    const still = data.motions[0]!.columns.length === 0;
    const page = (this.page = mount(this.element, data, { row: () => this.rowShown(), changing: true, still }));
    const { head, canvas, side } = page.places;
    head.insertBefore(this.shell.bar.element, head.querySelector(".lw-corner"));
    canvas.after(this.readiness.element, this.shell.notices.element);
    side.querySelector(".lw-questions")!.after(this.tabs.element);
    this.hint = head.closest(".lw")!.querySelector(".lw-hint")!;
    this.hint.textContent = "Drag a pin or a link.";
    this.newton.attach(page);
    this.plots.attach(page);
    presentNewton(page, this.tabs, this.newton, () => this.simulate.elsewhere, () => !this.rowless && this.moving !== null && this.editor.choose("move"));
    if (this.first) canvas.before(this.first);
    this.canvas.attach(page);
    this.editor.attach(page);
    if (view) page.places.drawing.see(view);
  }

  private rowShown(): void {
    this.newton.moved();
    this.canvas.moved();
  }

  /** Another tool: the sketch is asked for while it is edited. */
  private chosen(edited: boolean): void {
    const { drawing } = this.page!.places;
    if (edited) {
      this.page!.play(false);
      this.element.querySelector(".lw")!.classList.add("lw-still"); // the drawing has its size of a sketch now
      const empty = Object.keys(this.file!.points).length === 0;
      drawing.see(empty ? { x: 0, y: 0, width: SHEETS[this.file!.length_unit] ?? 240 } : wider(drawing.window));
    } else {
      drawing.see(null);
      this.sketched = null;
      this.readiness.rest();
    }
    this.sheet();
    if (!edited) this.display();
  }

  /** Symbols of a sketch have the size of the view. */
  private viewed(): void {
    if (!this.editor.edited || this.page === null) return;
    const { symbolWidth: width } = this.page.places.drawing;
    if (Math.abs(Math.log(width / this.width)) < RESIZED) return;
    clearTimeout(this.resizing);
    this.resizing = setTimeout(() => this.sheet(), 150);
  }

  /** Tell the width by which symbols are sized. */
  private sheet(): void {
    const { symbolWidth: width } = this.page!.places.drawing;
    this.width = width;
    this.connection.ask({ kind: "set_sheet", width, edited: this.editor.edited });
  }

  private sketch(event: SketchShown): void {
    this.sketched = event.page;
    const { lacks, readable, points } = this.file!;
    if (lacks.length) {
      this.moving = null;
      this.shell.notices.calm();
    }
    this.display();
    // what does not move is there to be edited
    if (lacks.length && readable && !this.editor.edited) this.editor.choose(Object.keys(points).length ? "select" : "link");
    this.updated();
  }

  /** Show a position instead of a motion. */
  private still(page: PageData | null, text: string): void {
    this.sketched = page;
    this.moving = null;
    if (page !== null) this.display();
    else this.instead();
    if (text) this.shell.notices.open(text, []);
  }

  /** Show equations if there is nothing to draw. */
  private instead(): void {
    if (this.page === null) this.begin(blank(this.file!));
    const box = html("div", { class: "lw-instead lw-plain-equations" });
    for (const equation of this.file!.equations) html("p", {}, box, equation);
    this.page!.places.canvas.querySelector(".lw-instead")?.remove();
    this.page!.places.canvas.append(box);
  }

  private open(event: CannotClose): void {
    // while the sketch is edited it stays: the points are dragged where they are in the file
    const drawn = this.editor.edited && this.sketched !== null;
    if (!drawn) this.still(event.page, event.page === null ? event.message : "");
    if (event.page === null) return;
    if (!drawn) this.gaps(event);
    const { text, remedies } = closing(event, this.file!);
    const choices = remedies.map(({ label, title, request }) => [label, title, () => void this.shell.background(request)] as const);
    this.shell.notices.open(text, choices);
    this.updated();
  }

  /** Dashed lines between ends of links that do not meet. */
  private gaps({ open_ends }: CannotClose): void {
    const { drawing } = this.page!.places;
    drawing.element.querySelector(".lw-gaps")?.remove();
    const group = svg("g", { class: "lw-gaps" }, drawing.element);
    drawGaps(group, open_ends, drawing.pixel);
  }

  private lost(message: string): void {
    this.shell.lost(message, this.element, this.tabs.element);
    if (this.page !== null) return;
    const alone = html("div", { class: "lw lw-wait", role: "alert" });
    html("h1", {}, alone, "Linkwork");
    html("p", {}, alone, message);
    html("button", { type: "button" }, alone, "Reload").addEventListener("click", () => location.reload());
    this.element.replaceChildren(alone);
  }
}

/** A view with room around it, to draw on. */
function wider({ x, y, width }: { x: number; y: number; width: number }): { x: number; y: number; width: number } {
  return { x, y, width: 1.3 * width };
}
