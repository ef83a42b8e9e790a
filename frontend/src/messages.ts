// Written by scripts/frontend types from the dataclasses in
// linkwork.app.live.requests and linkwork.app.live.events: change those.

import type { PageData } from "./page_data";

export interface SetNumber {
  kind: "set_number";
  id?: number;
  name: string;
  value: number | string;
  any_formula?: boolean;
  live?: boolean;
  rates?: boolean;
}

export interface MovePoint {
  kind: "move_point";
  id?: number;
  point: string;
  x: number;
  y: number;
  lengths_follow?: boolean;
  live?: boolean;
}

export interface MovePoints {
  kind: "move_points";
  id?: number;
  places: Record<string, readonly [number, number]>;
  keep?: readonly (string)[];
  live?: boolean;
  rates?: boolean;
}

export interface SetInput {
  kind: "set_input";
  id?: number;
  number?: number;
  drive?: string | null;
  name?: string | null;
  start?: number | string | null;
  stop?: number | string | null;
  step?: number | string | null;
  speed?: number | string | null;
}

export interface SetMass {
  kind: "set_mass";
  id?: number;
  link: string;
  mass?: number | string | null;
  x?: number | string | null;
  y?: number | string | null;
  inertia?: number | string | null;
}

export interface SetEntry {
  kind: "set_entry";
  id?: number;
  table: string;
  of: string;
  typed: Record<string, string | readonly (string)[]>;
  remove?: boolean;
}

export interface AddPoint {
  kind: "add_point";
  id?: number;
  name: string;
  x: number | string;
  y: number | string;
  links?: readonly (string)[];
}

export interface RemovePoint {
  kind: "remove_point";
  id?: number;
  name: string;
}

export interface AddLink {
  kind: "add_link";
  id?: number;
  name: string;
  points: readonly (string)[];
}

export interface RemoveLink {
  kind: "remove_link";
  id?: number;
  name: string;
}

export interface ReverseLink {
  kind: "reverse_link";
  id?: number;
  name: string;
}

export interface SetGround {
  kind: "set_ground";
  id?: number;
  points: readonly (string)[];
  on?: boolean;
}

export interface AddJoint {
  kind: "add_joint";
  id?: number;
  link: string;
  point: string;
}

export interface RemoveJoint {
  kind: "remove_joint";
  id?: number;
  link: string;
  point: string;
}

export interface AddPart {
  kind: "add_part";
  id?: number;
  table: string;
  typed: Record<string, string | readonly (string)[]>;
}

export interface DrawPart {
  kind: "draw_part";
  id?: number;
  table: string;
  picks: readonly (Picked)[];
  span: number;
}

export interface SetPart {
  kind: "set_part";
  id?: number;
  name: string;
  key: string;
  typed: string | readonly (string)[];
}

export interface RemovePart {
  kind: "remove_part";
  id?: number;
  name: string;
  whole?: boolean;
}

export interface TracePoint {
  kind: "trace_point";
  id?: number;
  point: string;
  on: boolean;
}

export interface ChooseConfiguration {
  kind: "choose_configuration";
  id?: number;
  name: string;
}

export interface AddOutput {
  kind: "add_output";
  id?: number;
  name: string;
  formula: string;
}

export interface ChangeUnits {
  kind: "change_units";
  id?: number;
  convert: boolean;
  length?: string;
  angle?: string;
}

export interface Rename {
  kind: "rename";
  id?: number;
  of: string;
  name: string;
  new: string;
}

export interface Duplicate {
  kind: "duplicate";
  id?: number;
  names: Record<string, string>;
  places: Record<string, readonly [number, number]>;
  mirrored?: boolean;
}

export interface Mirror {
  kind: "mirror";
  id?: number;
  places: Record<string, readonly [number, number]>;
}

export interface Together {
  kind: "together";
  id?: number;
  edits: readonly (LiveEdit)[];
}

export interface AssembleAt {
  kind: "assemble_at";
  id?: number;
  at: Record<string, number>;
}

export interface SetText {
  kind: "set_text";
  id?: number;
  text: string;
}

export interface SetSheet {
  kind: "set_sheet";
  id?: number;
  width: number;
  edited?: boolean;
}

export interface SolveAt {
  kind: "solve_at";
  id?: number;
  at: Record<string, number>;
  configuration?: string | null;
}

export interface ShowQuantities {
  kind: "show_quantities";
  id?: number;
  names: readonly (string)[];
  simulated?: boolean;
}

export interface Simulate {
  kind: "simulate";
  id?: number;
  until: number | string;
  start_speed?: number | string;
  start_speeds?: Record<string, number | string> | null;
  at?: Record<string, number | string> | null;
  change_points?: string;
  step?: number | string | null;
}

export interface Cancel {
  kind: "cancel";
  id?: number;
}

export interface ListConfigurations {
  kind: "list_configurations";
  id?: number;
  at: Record<string, number>;
}

export interface NewtonSteps {
  kind: "newton_steps";
  id?: number;
  guess: Record<string, number>;
  at: Record<string, number>;
  full_steps?: boolean;
  max_steps?: number;
  pull?: string;
  x?: number;
  y?: number;
}

export interface ListCircuits {
  kind: "list_circuits";
  id?: number;
}

export interface ListQuantities {
  kind: "list_quantities";
  id?: number;
  simulated?: boolean;
}

export interface Export {
  kind: "export";
  id?: number;
  format: string;
  row?: number | null;
  dark?: boolean;
  simulated?: boolean;
}

export interface MakeLink {
  kind: "make_link";
  id?: number;
  app?: string;
}

export interface OpenExample {
  kind: "open_example";
  id?: number;
  name: string;
  discard?: boolean;
}

export interface OpenFile {
  kind: "open_file";
  id?: number;
  name: string;
  content: string;
  discard?: boolean;
}

export interface Undo {
  kind: "undo";
  id?: number;
}

export interface Redo {
  kind: "redo";
  id?: number;
}

export interface Save {
  kind: "save";
  id?: number;
  overwrite?: boolean;
}

export interface Reload {
  kind: "reload";
  id?: number;
}

export interface MoveTaskPoint {
  kind: "move_task_point";
  id?: number;
  of: string;
  index: number;
  x: number;
  y: number;
  radius?: number | null;
  live?: boolean;
}

export interface TurnPose {
  kind: "turn_pose";
  id?: number;
  index: number;
  angle: number;
  live?: boolean;
}

export interface AddTaskPoint {
  kind: "add_task_point";
  id?: number;
  of: string;
  x: number;
  y: number;
  radius?: number;
}

export interface RemoveTaskPoint {
  kind: "remove_task_point";
  id?: number;
  of: string;
  index: number;
}

export interface SetTaskEntry {
  kind: "set_task_entry";
  id?: number;
  key: string;
  value?: number | string | null;
  live?: boolean;
}

export interface DrawCurve {
  kind: "draw_curve";
  id?: number;
  points: readonly (number)[];
}

export interface SetRegion {
  kind: "set_region";
  id?: number;
  corners: readonly (number)[];
}

export interface ShowDesign {
  kind: "show_design";
  id?: number;
  design: number;
}

export interface ShowCognates {
  kind: "show_cognates";
  id?: number;
  design: number;
}

export interface FindNearest {
  kind: "find_nearest";
  id?: number;
  count?: number;
}

export interface ImproveDesign {
  kind: "improve_design";
  id?: number;
  design: number;
}

export interface SolveTask {
  kind: "solve_task";
  id?: number;
}

export interface OpenTask {
  kind: "open_task";
  id?: number;
  name: string;
  discard?: boolean;
}

export interface OpenDesign {
  kind: "open_design";
  id?: number;
  design: number;
}

export interface ReturnToTask {
  kind: "return_to_task";
  id?: number;
  discard?: boolean;
}

export interface PaletteShown {
  kind: "palette_shown";
  answers: number | null;
  parts: readonly (PalettePart)[];
  forms: readonly (PaletteForm)[];
}

export interface FileState {
  kind: "file_state";
  answers: number | null;
  file: string;
  title: string;
  text: string;
  form: string;
  unsaved: boolean;
  undo: string;
  redo: string;
  length_unit: string;
  angle_unit: string;
  configuration: string;
  numbers: readonly (ChangeableNumber)[];
  unknowns: readonly (Unknown)[];
  inputs: readonly (DrivenInput)[];
  points: Record<string, readonly [number, number]>;
  links: readonly (Link)[];
  parts: readonly (string)[];
  part_entries: readonly (PartShown)[];
  masses: readonly (MassShown)[];
  mass_unit: string;
  force_unit: string;
  force_entries: readonly (EntryShown)[];
  drives: readonly (Drive)[];
  traceable: readonly (string)[];
  traced: readonly (string)[];
  outputs: readonly (string)[];
  equations: readonly (string)[];
  lacks: readonly (Lack)[];
  readable: boolean;
}

export interface SketchShown {
  kind: "sketch_shown";
  answers: number | null;
  page: PageData;
}

export interface MotionFound {
  kind: "motion_found";
  answers: number | null;
  live: boolean;
  rows: number;
  missing: number;
  certified: number;
  limits: readonly (LimitFound)[];
  message: string;
  page: PageData | null;
}

export interface PositionFound {
  kind: "position_found";
  answers: number | null;
  status: string;
  message: string;
  input: Record<string, number>;
  unknowns: Record<string, number | null>;
  links: Record<string, number | null>;
  sliders: Record<string, number | null>;
  outputs: Record<string, number | null>;
  points: Record<string, readonly [number, number]>;
  residual: number | null;
  iterations: number;
  condition: number | null;
  certified: boolean;
  page: PageData | null;
}

export interface CannotClose {
  kind: "cannot_close";
  answers: number | null;
  message: string;
  input: Record<string, number>;
  gap: number;
  gaps: Record<string, readonly [number, number]>;
  unknowns: Record<string, number>;
  points: Record<string, readonly [number, number]>;
  open_ends: readonly (OpenEnd)[];
  remedies: Record<string, number>;
  elsewhere: Record<string, number>;
  page: PageData | null;
}

export interface ConfigurationsFound {
  kind: "configurations_found";
  answers: number | null;
  input: Record<string, number>;
  ways: readonly (Way)[];
  completeness: string;
}

export interface CircuitsFound {
  kind: "circuits_found";
  answers: number | null;
  input: string;
  input_unit: string;
  circuits: readonly (CircuitFound)[];
  message: string;
  page: PageData | null;
}

export interface QuantitiesListed {
  kind: "quantities_listed";
  answers: number | null;
  quantities: readonly (QuantityListed)[];
}

export interface Exported {
  kind: "exported";
  answers: number | null;
  name: string;
  media_type: string;
  content: string;
  notices: readonly (string)[];
}

export interface SimulationFound {
  kind: "simulation_found";
  answers: number | null;
  message: string;
  complete: boolean;
  rows: number;
  certified: number;
  energy: string;
  events: readonly (SimulationEvent)[];
  forms: readonly (FormOffered)[];
  page: PageData | null;
}

export interface Working {
  kind: "working";
  answers: number | null;
  fraction: number;
}

export interface NewtonShown {
  kind: "newton_shown";
  answers: number | null;
  guess: Record<string, number>;
  guessed: readonly (string)[];
  iterates: readonly (NewtonIterate)[];
  status: string;
  trouble: string;
  message: string;
  input: Record<string, number>;
  unknowns: Record<string, number | null>;
  points: Record<string, readonly [number, number]>;
}

export interface PointMoved {
  kind: "point_moved";
  answers: number | null;
  point: string;
  followed: readonly (string)[];
  stayed: readonly (string)[];
}

export interface ProblemsFound {
  kind: "problems_found";
  answers: number | null;
  where: string;
  problems: readonly (ProblemShown)[];
}

export interface Refused {
  kind: "refused";
  answers: number | null;
  message: string;
}

export interface LinkMade {
  kind: "link_made";
  answers: number | null;
  link: string;
  embed: string;
  qr: string;
  note: string;
}

export interface FileChanged {
  kind: "file_changed";
  answers: number | null;
  message: string;
  reloaded: boolean;
  unsaved: boolean;
  missing: boolean;
}

export interface FileOpened {
  kind: "file_opened";
  answers: number | null;
  source: string;
  format: string;
  carried: Record<string, number>;
  renamed: Record<string, string>;
  left_out: readonly (string)[];
}

export interface Saved {
  kind: "saved";
  answers: number | null;
  file: string;
}

export interface StartOffered {
  kind: "start_offered";
  answers: number | null;
}

export interface TaskState {
  kind: "task_state";
  answers: number | null;
  file: string;
  title: string;
  text: string;
  unsaved: boolean;
  undo: string;
  redo: string;
  task: string;
  length_unit: string;
  angle_unit: string;
  positions: readonly (PositionShown)[];
  positions_from_file: boolean;
  fixed_pivots: readonly (readonly [number, number])[];
  moving_pivots: readonly (readonly [number, number])[];
  region: readonly (readonly [number, number])[];
  obstacles: readonly (readonly [number, number, number])[];
  entries: Record<string, number | string>;
  problems: readonly (ProblemShown)[];
}

export interface TaskSolved {
  kind: "task_solved";
  answers: number | null;
  live: boolean;
  solutions: string;
  linkages: number;
  count: number;
  sound: number;
  delivered: number;
  completeness: string;
  message: string;
  interrupted: boolean;
  error_unit: string;
  defects: Record<string, number>;
  most_restrictive: string;
  costs: number;
  advice: string;
  designs: readonly (DesignShown)[];
  left_out: number;
  dyads: readonly (DyadShown)[];
  centre_curve: readonly (readonly (number)[])[];
  chosen: DesignFound | null;
}

export interface TaskUnsolved {
  kind: "task_unsolved";
  answers: number | null;
  live: boolean;
  message: string;
  problems: readonly (ProblemShown)[];
  slow: boolean;
  ended: boolean;
}

export interface DesignFound {
  kind: "design_found";
  answers: number | null;
  design: DesignShown;
  skeleton: SkeletonShown | null;
  fixed: readonly (readonly (readonly [number, number])[])[];
  guided: string;
  lines: readonly [number | null, number | null];
  at: readonly (readonly (number)[])[];
  rows: readonly (readonly (number)[])[];
  marks: readonly (number)[];
  curve: readonly (readonly (number)[])[];
}

export interface DesignOpened {
  kind: "design_opened";
  answers: number | null;
  task: string;
}

export interface DesignsSuggested {
  kind: "designs_suggested";
  answers: number | null;
  designs: readonly (DesignShown)[];
  note: string;
}

export interface CognatesFound {
  kind: "cognates_found";
  answers: number | null;
  design: number;
  cognates: readonly (CognateShown)[];
  curve: readonly (readonly (number)[])[];
}

export interface Picked {
  x: number;
  y: number;
  point?: string;
  link?: string;
  size?: number;
}

export interface PalettePart {
  table: string;
  title: string;
  doc: string;
  fields: readonly (PaletteField)[];
  picks: readonly (Pick)[];
}

export interface PaletteField {
  name: string;
  doc: string;
  entry: string;
  required: boolean;
  words: readonly (string)[];
  named: readonly (string)[];
}

export interface Pick {
  prompt: string;
  takes: readonly (string)[];
  sized: boolean;
  repeated: boolean;
}

export interface PaletteForm {
  table: string;
  title: string;
  doc: string;
  fields: readonly (PaletteField)[];
}

export interface ChangeableNumber {
  name: string;
  value: number;
  unit: string;
  table: string;
  formula: string;
}

export interface Unknown {
  name: string;
  unit: string;
  guess: number;
}

export interface DrivenInput {
  name: string;
  unit: string;
  drive: string;
  start: number;
  stop: number;
  rows: number;
  speed: string;
}

export interface Link {
  name: string;
  points: readonly (string)[];
}

export interface PartShown {
  table: string;
  name: string;
  typed: Record<string, string | readonly (string)[]>;
  links: readonly (string)[];
  points: readonly (string)[];
}

export interface MassShown {
  link: string;
  mass: string;
  x: string;
  y: string;
  inertia: string;
  rod: boolean;
}

export interface EntryShown {
  table: string;
  of: string;
  takes: readonly (string)[];
  there: boolean;
  typed: Record<string, string | readonly (string)[]>;
}

export interface Drive {
  kind: string;
  name: string;
}

export interface Lack {
  message: string;
  key: string;
  line: number | null;
  kind: string;
  name: string;
  remedies: readonly (Remedy)[];
}

export interface Remedy {
  label: string;
  edits: readonly (LiveEdit)[];
}

export interface LimitFound {
  what: string;
  input: number;
  located: boolean;
  sentence: string;
}

export interface OpenEnd {
  link: string;
  point: string;
  joint: readonly [number, number];
  end: readonly [number, number];
}

export interface Way {
  name: string;
  unknowns: Record<string, number>;
  points: Record<string, readonly [number, number]>;
}

export interface CircuitFound {
  name: string;
  current: boolean;
  end: string;
  certified: boolean;
  input_range: readonly [number, number];
  turns: number | null;
  limits: readonly (LimitFound)[];
  branches: readonly (BranchFound)[];
}

export interface BranchFound {
  name: string;
  start: string;
  input_range: readonly [number, number];
  certified: boolean;
}

export interface QuantityListed {
  name: string;
  unit: string;
  about: string;
  derivatives: number;
}

export interface SimulationEvent {
  row: number;
  t: number;
  text: string;
}

export interface FormOffered {
  form: string;
  label: string;
}

export interface NewtonIterate {
  equations: readonly (string)[];
  k: number;
  unknowns: Record<string, number | null>;
  residuals: readonly (number | null)[];
  norm: number | null;
  jacobian: readonly (readonly (number | null)[])[];
  step: number | null;
  points: Record<string, readonly [number, number]>;
  open_ends: readonly (OpenEnd)[];
}

export interface ProblemShown {
  line: number | null;
  key: string;
  message: string;
}

export interface PositionShown {
  x: number;
  y: number;
  angle: number | null;
  input: number | null;
  tolerance: number;
  angle_tolerance: number;
}

export interface DesignShown {
  index: number;
  origin: string;
  number: number;
  mechanism: string;
  drive: string;
  sound: boolean;
  delivered: boolean;
  transmission: number | null;
  size: number | null;
  error: number | null;
  score: number | null;
  reason: string;
  remark: string;
}

export interface DyadShown {
  kind: string;
  fixed: readonly [number, number];
  proved: boolean;
}

export interface SkeletonShown {
  bars: readonly (readonly (number)[])[];
  driven: readonly (boolean)[];
  fixed: readonly (number)[];
  pins: readonly (number)[];
  blocks: readonly (readonly [number, number, number])[];
  discs: readonly (readonly [number, number])[];
}

export interface CognateShown {
  points: Record<string, readonly [number, number]>;
  drive: string;
  index: number;
  sound: boolean;
  reason: string;
}

export type LiveEdit =
  | SetNumber
  | MovePoint
  | MovePoints
  | SetInput
  | SetMass
  | SetEntry
  | AddPoint
  | RemovePoint
  | AddLink
  | RemoveLink
  | ReverseLink
  | SetGround
  | AddJoint
  | RemoveJoint
  | AddPart
  | DrawPart
  | SetPart
  | RemovePart
  | TracePoint
  | ChooseConfiguration
  | AddOutput
  | ChangeUnits
  | Rename
  | Duplicate
  | Mirror;

export type LiveRequest =
  | SetNumber
  | MovePoint
  | MovePoints
  | SetInput
  | SetMass
  | SetEntry
  | AddPoint
  | RemovePoint
  | AddLink
  | RemoveLink
  | ReverseLink
  | SetGround
  | AddJoint
  | RemoveJoint
  | AddPart
  | DrawPart
  | SetPart
  | RemovePart
  | TracePoint
  | ChooseConfiguration
  | AddOutput
  | ChangeUnits
  | Rename
  | Duplicate
  | Mirror
  | Together
  | AssembleAt
  | SetText
  | SetSheet
  | SolveAt
  | ShowQuantities
  | Simulate
  | Cancel
  | ListConfigurations
  | NewtonSteps
  | ListCircuits
  | ListQuantities
  | Export
  | MakeLink
  | OpenExample
  | OpenFile
  | Undo
  | Redo
  | Save
  | Reload
  | MoveTaskPoint
  | TurnPose
  | AddTaskPoint
  | RemoveTaskPoint
  | SetTaskEntry
  | DrawCurve
  | SetRegion
  | ShowDesign
  | ShowCognates
  | FindNearest
  | ImproveDesign
  | SolveTask
  | OpenTask
  | OpenDesign
  | ReturnToTask;

export type LiveEvent =
  | PaletteShown
  | FileState
  | SketchShown
  | MotionFound
  | PositionFound
  | CannotClose
  | ConfigurationsFound
  | CircuitsFound
  | QuantitiesListed
  | Exported
  | SimulationFound
  | Working
  | NewtonShown
  | PointMoved
  | ProblemsFound
  | Refused
  | LinkMade
  | FileChanged
  | FileOpened
  | Saved
  | StartOffered
  | TaskState
  | TaskSolved
  | TaskUnsolved
  | DesignFound
  | DesignOpened
  | DesignsSuggested
  | CognatesFound;
