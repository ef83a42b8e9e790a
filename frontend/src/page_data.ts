// Written by scripts/frontend types from src/linkwork/app/pages/page_data.py.

/** The right answers to a question, any one of which will do; none may be right, or none may be `known`. */
export interface AnswerData {
  readonly known: boolean;
  readonly values: readonly number[];
}

/** A quantity over the rows: its printed name and unit; `group` is its list: `input`, `unknown`, `output`, `derived`, or `asked` for any other quantity or rate. `band`: lowest and highest recommended value. */
export interface Column {
  readonly name: string;
  readonly shown: string;
  readonly unit: string;
  readonly group: string;
  readonly values: PackedColumn;
  readonly first: PackedColumn | null;
  readonly first_unit: string;
  readonly band: readonly number[];
}

/** A loop equation: its label and its MathML. */
export interface Equation {
  readonly label: string;
  readonly mathml: string;
}

/** A force on a point, given by index. */
export interface ForceData {
  readonly point: number;
  readonly x: number;
  readonly y: number;
}

/** The frame of a shape: indices of a point and of a turn; -1 for none. */
export interface FrameData {
  readonly origin: number;
  readonly turn: number;
}

/** A row at a dead point or change point. */
export interface LimitMark {
  readonly row: number;
  readonly text: string;
}

/** One displayed circuit or branch. `order` are the solved rows in the order of the motion; `closed`: the first follows the last. `speed` is that of the leading input, 0 if it has none; `backwards`: its arrow points towards smaller values. `view` is the extent of its drawing, as that of the page. */
export interface MotionData {
  readonly name: string;
  readonly summary: string;
  readonly rows: number;
  readonly order: PackedColumn;
  readonly closed: boolean;
  readonly speed: number;
  readonly backwards: boolean;
  readonly columns: readonly Column[];
  readonly points: readonly PointData[];
  readonly turns: readonly TurnData[];
  readonly frames: readonly FrameData[];
  readonly parts: readonly Part[];
  readonly vectors: readonly VectorData[];
  readonly driven: readonly string[];
  readonly evidence: RowEvidence;
  readonly limits: readonly LimitMark[];
  readonly numbers: readonly MotionNumber[];
  readonly answers: readonly AnswerData[];
  readonly view: readonly number[];
  readonly reactions: readonly ReactionData[];
}

/** One number of the whole motion, such as `stroke(s16)`; `None` if undefined. */
export interface MotionNumber {
  readonly name: string;
  readonly shown: string;
  readonly unit: string;
  readonly value: number | null;
}

/** Numbers of the solved rows: multiples of `step`, differenced `order` times, as zigzag integers of seven bits per byte, in base64. Order -1: plain little-endian floats of eight bytes; -2: of four. `gaps` are indices of rows without a number, such as derivatives at dead points; plain floats have NaN there. */
export interface PackedColumn {
  readonly step: number;
  readonly order: number;
  readonly content: string;
  readonly gaps: readonly number[];
}

/** The complete data of a page. `view` is left, bottom, right, top of the drawing. */
export interface PageData {
  readonly format: number;
  readonly title: string;
  readonly length_unit: string;
  readonly derivative_unit: string;
  readonly input_unit: string;
  readonly view: readonly number[];
  readonly stroke: number;
  readonly pin: number;
  readonly text: number;
  readonly motions: readonly MotionData[];
  readonly light: ThemeData;
  readonly dark: ThemeData;
  readonly forces: readonly ForceData[];
  readonly force_unit: string;
  readonly equations: readonly Equation[];
  readonly questions: readonly QuestionData[];
}

/** A shape: `line`, `area`, `disc`, `strokes` or `text`. `points` are x, y, x, y, … in its frame (`frame` ≥ 0) or in the plane (-1); of a disc its centre, of a text its anchor. A deforming shape (`frame` -2) has packed x and y of each corner, and `shown` (1 or 0) in every row. Lengths are in the mechanism's unit. */
export interface Part {
  readonly kind: string;
  readonly role: string;
  readonly of: string;
  readonly tone: number;
  readonly frame: number;
  readonly points: readonly number[];
  readonly radius: number;
  readonly head: readonly number[];
  readonly text: string;
  readonly offset: readonly number[];
  readonly height: number;
  readonly align: number;
  readonly course: readonly PackedColumn[];
  readonly shown: PackedColumn | null;
}

/** A point: its coordinates and their first and second derivatives with respect to the input. */
export interface PointData {
  readonly name: string;
  readonly shown: string;
  readonly drawn: boolean;
  readonly x: PackedColumn;
  readonly y: PackedColumn;
  readonly dx: PackedColumn;
  readonly dy: PackedColumn;
  readonly ddx: PackedColumn;
  readonly ddy: PackedColumn;
}

/** A question: the unit, tolerance and whole turn (0: none) of its answer, and what is hidden until it is answered. */
export interface QuestionData {
  readonly text: string;
  readonly unit: string;
  readonly tolerance: number;
  readonly turn: number;
  readonly hide: readonly string[];
}

/** A force on a point, given by index, of the link `by` on the link `on`, "" for loads; `x` and `y` name the columns of its components. */
export interface ReactionData {
  readonly point: number;
  readonly on: string;
  readonly by: string;
  readonly x: string;
  readonly y: string;
}

/** The style of a role: colours (`tone`: that of the link; "" for none), widths in strokes. */
export interface RoleStyle {
  readonly role: string;
  readonly layer: number;
  readonly line: string;
  readonly width: number;
  readonly fill: string;
  readonly opacity: number;
  readonly dashes: readonly number[];
}

/** The evidence of every row; `found` is 1 or 0, statuses are indices into `texts`. */
export interface RowEvidence {
  readonly found: PackedColumn;
  readonly status: PackedColumn;
  readonly status_texts: readonly string[];
  readonly certification: PackedColumn;
  readonly certification_texts: readonly string[];
  readonly certified: PackedColumn;
  readonly residual_log10: PackedColumn;
  readonly radius_log10: PackedColumn;
  readonly iterations: PackedColumn;
  readonly branch: PackedColumn;
  readonly branch_names: readonly string[];
}

/** A number that can be changed in the page; `unit` is empty where it is unknown. `hidden`: parts that are not drawn while it differs from `value`. */
export interface SliderData {
  readonly name: string;
  readonly unit: string;
  readonly value: number;
  readonly hidden: readonly number[];
}

/** What a page needs to solve, besides its printed functions. `unknowns` to `options`: layout of the functions' arrays, see `batch.printed_solver`. `steps`: first, largest and smallest step; `turn`: a whole turn of the input, 0 where it does not turn freely; `apart`: rounding of an input a turn away; `path`: values of the table's line of inputs, `rates` and `origins` of all inputs on it, and their `inputs` in the unit of the file, row by row. `columns`: names of computed columns. `frames` replace those of the motion; `anchors`: points that the corners of each part move with, -1 for none. */
export interface SolverData {
  readonly title: string;
  readonly sliders: readonly SliderData[];
  readonly unknowns: number;
  readonly size: number;
  readonly blocks: number;
  readonly coefficients: number;
  readonly spread: readonly number[];
  readonly state: number;
  readonly design: number;
  readonly drawn: number;
  readonly options: readonly number[];
  readonly rules: StepRules;
  readonly steps: readonly number[];
  readonly turn: number;
  readonly apart: number;
  readonly path: PackedColumn;
  readonly origins: readonly number[];
  readonly rates: readonly number[];
  readonly inputs: readonly PackedColumn[];
  readonly input_unit: number;
  readonly columns: readonly string[];
  readonly turns: readonly TurnSource[];
  readonly tracks: readonly TrackData[];
  readonly frames: readonly FrameData[];
  readonly anchors: readonly (readonly number[])[];
}

/** Constants of `marching` and of the programs; see there. */
export interface StepRules {
  readonly nodes: number;
  readonly growth: number;
  readonly half: number;
  readonly nearly_full: number;
  readonly far: number;
  readonly same: number;
  readonly newton_steps: number;
  readonly start_steps: number;
}

/** Colours of a page, light or dark. */
export interface ThemeData {
  readonly background: string;
  readonly ink: string;
  readonly faint: string;
  readonly driven: string;
  readonly tones: readonly string[];
  readonly styles: readonly RoleStyle[];
}

/** A track: the point guided by it and its frame, given by index (-1: the ground), and its direction there. The ends of the point's path count as two more points, after the named ones. */
export interface TrackData {
  readonly point: number;
  readonly frame: number;
  readonly x: number;
  readonly y: number;
}

/** The angle [rad] of a link or line with which shapes rotate. */
export interface TurnData {
  readonly name: string;
  readonly angle: PackedColumn;
}

/** Where the angle of a turn comes from: the number of a computed angle, or -1 and the points of a line, given by index. */
export interface TurnSource {
  readonly angle: number;
  readonly start: number;
  readonly end: number;
}

/** A vector of a loop equation with its name, between two points given by index. If it is not between points, these are -1, and `course` has x and y of its tail and tip. */
export interface VectorData {
  readonly name: string;
  readonly start: number;
  readonly end: number;
  readonly tone: number;
  readonly course: readonly PackedColumn[];
}
