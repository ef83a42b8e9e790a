// The entry point of the offline page.

import { start } from "./start";

start();
