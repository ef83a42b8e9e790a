// The live page: drawing and player as on every page, with panels that edit the file.

import type { CannotClose, FileState, LiveEvent, LiveRequest, MotionFound } from "../messages";
import { mount, type Mounted } from "../mount";
import { themeButton } from "../theme_button";
import { unitText } from "../chart";
import { shortNumber, trimmed } from "../numbers";
import { html } from "../svg";
import type { Desk } from "./asking";
import { Bar } from "./bar";
import { Build } from "./build";
import { Connection } from "./connection";
import { Dimensions } from "./dimensions";
import { Latest } from "./latest";
import { Newton } from "./newton";
import { Notices } from "./notices";
import { pictureOf, type Points } from "./schematic";
import { Sketch } from "./sketch";
import { Tabs } from "./tabs";
import { Ways } from "./ways";

/** Events that answer a request, so that the next can be sent. */
const ANSWERS = new Set(["motion_found", "cannot_close", "position_found", "newton_shown", "refused", "problems_found"]);

export class LivePage {
  private readonly connection: Connection;
  private readonly latest: Latest<LiveRequest>;
  private readonly bar: Bar;
  private readonly notices = new Notices();
  private readonly dimensions: Dimensions;
  private readonly ways: Ways;
  private readonly newton: Newton;
  private readonly build: Build;
  private readonly sketch: Sketch;
  private readonly tabs: Tabs;
  private readonly picture = html("div", { class: "lw-instead" });
  private file: FileState | null = null;
  private page: Mounted | null = null;
  private plain: HTMLElement | null = null;
  /** Whether no row of the table has a position. */
  private rowless = false;

  constructor(private readonly element: HTMLElement) {
    const desk = this.desk();
    this.bar = new Bar(desk);
    this.dimensions = new Dimensions(desk);
    this.ways = new Ways(desk);
    this.newton = new Newton(desk);
    this.build = new Build(desk);
    this.sketch = new Sketch(desk);
    this.tabs = new Tabs([
      { title: "Dimensions", element: this.dimensions.element },
      { title: "Configurations", element: this.ways.element, shown: (on) => this.ways.shown(on) },
      { title: "Newton", element: this.newton.element, shown: (on) => this.newton.shown(on) },
      { title: "Build", element: this.build.element },
    ]);
    this.connection = new Connection({
      event: (event) => this.told(event),
      lost: (message) => this.lost(message),
    });
    this.latest = new Latest((request) => this.connection.ask(request));
  }

  private desk(): Desk {
    return {
      ask: (request) => {
        this.latest.clear();
        this.notices.clear();
        this.connection.ask(request);
      },
      latest: (request) => this.latest.put(request),
      file: () => this.file!,
      here: () => this.here(),
      values: () => this.page?.values ?? {},
    };
  }

  private here(): Record<string, number> {
    const inputs = this.file?.inputs ?? [];
    const values = this.page?.values ?? {};
    return Object.fromEntries(inputs.flatMap(({ name }) => (name in values ? [[name, values[name]!]] : [])));
  }

  private told(event: LiveEvent): void {
    switch (event.kind) {
      case "palette_shown":
        this.build.offer(event.parts);
        break;
      case "file_state":
        this.state(event);
        break;
      case "motion_found":
        this.motion(event);
        break;
      case "cannot_close":
        this.open(event);
        break;
      case "position_found":
        if (this.page === null || this.rowless || !this.file!.inputs.length) this.still(event.points, this.rowless ? "" : event.message);
        break;
      case "configurations_found":
        this.ways.show(event);
        break;
      case "newton_shown":
        this.newton.show(event);
        break;
      case "point_moved":
        if (event.answers !== null && this.element.dataset.live !== "true") this.notices.done(this.sketch.told(event));
        break;
      case "problems_found":
        this.notices.problems(event);
        if (this.file) this.dimensions.show(this.file);
        break;
      case "refused":
        this.refused(event.message);
        break;
      case "file_changed":
        this.notices.changed(event, this.decisions());
        break;
      case "link_made":
        this.bar.link.show(event);
        break;
      case "saved":
        this.notices.done(`Saved in ${event.file}.`);
        break;
    }
    if (ANSWERS.has(event.kind)) this.latest.answered(event.answers);
  }

  private decisions(): Record<string, () => void> {
    return {
      Reload: () => this.connection.ask({ kind: "reload" }),
      Overwrite: () => this.connection.ask({ kind: "save", overwrite: true }),
    };
  }

  private refused(message: string): void {
    if (this.bar.link.opened) {
      this.bar.link.refuse(message);
      return;
    }
    const conflict = /overwrite/.test(message);
    this.notices.say(message, conflict ? this.decisions() : {});
    if (this.file) this.dimensions.show(this.file);
  }

  private state(file: FileState): void {
    this.file = file;
    this.bar.show(file);
    this.dimensions.show(file);
    this.build.show(file);
    this.ways.renew();
    this.newton.renew();
    this.sketch.renew();
  }

  private motion(found: MotionFound): void {
    const unit = this.file!.inputs[0]?.unit ?? "";
    this.rowless = found.page === null && found.missing === found.rows;
    if (found.page !== null) {
      this.picture.remove();
      this.element.classList.remove("lw-stays-open");
      if (this.page === null) this.begin(found);
      else this.page.update(found.page, found.live);
      this.element.dataset.live = String(found.live);
    } else if (found.missing < found.rows) {
      this.still({}, "This mechanism has no points to draw. The command linkwork sweep prints its numbers.");
    }
    this.notices.limits(found, unit, (input) => this.page?.goToInput(input));
    this.element.dataset.updates = String(Number(this.element.dataset.updates ?? 0) + 1);
  }

  private begin(found: MotionFound): void {
    this.plain = null;
    const page = (this.page = mount(this.element, found.page!, { row: () => this.newton.moved() }));
    const { head, canvas, side } = page.places;
    head.insertBefore(this.bar.element, head.querySelector(".lw-theme"));
    canvas.after(this.notices.element);
    side.prepend(this.tabs.element);
    head.closest(".lw")!.querySelector(".lw-hint")!.textContent = "Drag a pin or a link.";
    this.newton.attach(page);
    this.sketch.attach(page);
  }

  /** The same layout without a motion. */
  private places(): { canvas: HTMLElement } {
    if (this.page !== null) return this.page.places;
    if (this.plain === null) {
      this.plain = html("div", { class: "lw" });
      this.element.replaceChildren(this.plain);
      const head = html("header", { class: "lw-head" }, this.plain);
      html("h1", {}, head, this.file!.title);
      head.append(this.bar.element);
      themeButton(head, this.plain);
      const stage = html("section", { class: "lw-stage", "aria-label": "Drawing" }, this.plain);
      html("div", { class: "lw-canvas" }, stage);
      stage.append(this.notices.element);
      const side = html("section", { class: "lw-side", "aria-label": "Numbers" }, this.plain);
      side.append(this.tabs.element);
    }
    return { canvas: this.plain.querySelector(".lw-canvas")! };
  }

  /** Show a picture of points instead of a motion. */
  private still(points: Points, text: string): void {
    const { canvas } = this.places();
    const drawn = Object.keys(points).length > 0;
    this.picture.replaceChildren(drawn ? pictureOf(this.file!.links, points) : this.equations());
    canvas.append(this.picture);
    if (this.rowless) this.element.classList.add("lw-stays-open");
    if (text) this.notices.open(text, []);
  }

  /** Show equations if there is nothing to draw. */
  private equations(): HTMLElement {
    const box = html("div", { class: "lw-plain-equations" });
    for (const equation of this.file!.equations) html("p", {}, box, equation);
    return box;
  }

  private open(event: CannotClose): void {
    if (!Object.keys(event.points).length) {
      this.still({}, event.message);
      return;
    }
    const { canvas } = this.places();
    this.picture.replaceChildren(pictureOf(this.file!.links, event.points, event.open_ends));
    canvas.append(this.picture);
    this.element.classList.add("lw-stays-open");
    const unit = this.file!.length_unit;
    const gap = `${trimmed(shortNumber(event.gap, 4))} ${unit}`.trim();
    const remedies = Object.entries(event.remedies).map(([name, needed]) => {
      const now = this.file!.numbers.find((one) => one.name === name)?.value ?? needed;
      const value = Number((needed + 0.03 * (needed - now)).toPrecision(6)); // a little beyond where the loops just close
      const rounded = trimmed(shortNumber(value));
      const set = (): void => {
        this.connection.ask({ kind: "set_number", name, value });
      };
      return [`${name} = ${rounded}`, "Changing only this length closes the loops", set] as const;
    });
    const help = remedies.length ? " Any one of these changes closes the loops:" : "";
    const at = Object.entries(event.input).map(([name, value]) => `${name} = ${trimmed(shortNumber(value, 5))}${unitText(this.file!.inputs.find((one) => one.name === name)?.unit ?? "")}`);
    const where = at.length ? `At ${at.join(", ")} the loops` : "The loops";
    const elsewhere = Object.entries(event.elsewhere).map(([name, value]) => {
      const begin = (): void => {
        this.connection.ask({ kind: "assemble_at", at: event.elsewhere });
      };
      const unit = unitText(this.file!.inputs.find((one) => one.name === name)?.unit ?? "");
      return [`begin at ${name} = ${trimmed(shortNumber(value, 5))}${unit}`, "The loops close at this input: move the points of the sketch to that position", begin] as const;
    });
    const there = elsewhere.length ? (remedies.length ? " Or:" : " The loops close elsewhere:") : "";
    this.notices.open(`${where} cannot close: a gap of ${gap} remains.${help}${remedies.length ? "" : there}`, [...remedies, ...elsewhere]);
    this.element.dataset.updates = String(Number(this.element.dataset.updates ?? 0) + 1);
  }

  private lost(message: string): void {
    this.bar.close();
    if (this.page === null && this.plain === null) {
      this.element.replaceChildren(html("p", { class: "lw-wait", role: "alert" }, undefined, message));
      return;
    }
    this.element.classList.add("lw-lost");
    for (const input of this.tabs.element.querySelectorAll<HTMLInputElement>("input, button, select, textarea")) {
      input.disabled = true;
    }
    this.notices.say(message, { "Reload": () => location.reload() }, false);
  }
}
