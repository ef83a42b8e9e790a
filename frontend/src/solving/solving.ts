// The entry point of an offline page that solves its mechanism again when numbers are changed.

import type { SolverData } from "../page_data";
import { contained, start } from "../start";
import { programOf, type Printed } from "./march";
import { Sliders } from "./sliders";
import { SolvedPages } from "./solved_page";

declare global {
  interface Window {
    /** The printed functions of this page's mechanism. */
    linkworkProgram: Printed;
    /** For scripts: the solver of this page. */
    linkworkSolver: SolvedPages;
  }
}

start(async (page) => {
  const data = await contained<SolverData>("linkwork-solver");
  const pages = new SolvedPages(programOf(window.linkworkProgram), data, page);
  window.linkworkSolver = pages;
  new Sliders(data, pages, window.linkwork);
}, { changing: true });
