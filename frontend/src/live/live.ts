// The entry point of the live page of linkwork view.

import { html } from "../svg";
import { openPages } from "../task/opened";
import { Connection } from "./connection";

const element = document.getElementById("linkwork")!;
element.replaceChildren(html("p", { class: "lw-wait", role: "status" }, undefined, "Connecting …"));
openPages(element, (hooks) => new Connection(hooks));
