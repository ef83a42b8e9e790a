// Bundles the front end: node build.mjs FOLDER. The same sources give the same bytes.
import { build } from "esbuild";
import { mkdir } from "node:fs/promises";
import { join, resolve } from "node:path";

const folder = resolve(process.argv[2] ?? "../src/linkwork/app/static");
await mkdir(folder, { recursive: true });
const common = {
  bundle: true,
  minify: true,
  charset: "utf8",
  target: ["es2022"],
  legalComments: "none",
  logLevel: "warning",
};
await Promise.all([
  build({ ...common, entryPoints: ["src/offline.ts"], format: "iife", outfile: join(folder, "offline.js") }),
  build({
    ...common,
    entryPoints: ["src/solving/solving.ts"],
    format: "iife",
    outfile: join(folder, "solving.js"),
  }),
  build({ ...common, entryPoints: ["src/solving/solving.css"], outfile: join(folder, "solving.css") }),
  build({ ...common, entryPoints: ["src/live/live.ts"], format: "iife", outfile: join(folder, "live.js") }),
  build({ ...common, entryPoints: ["src/web/web.ts"], format: "iife", outfile: join(folder, "web.js") }),
  build({ ...common, entryPoints: ["src/web/worker.ts"], format: "iife", outfile: join(folder, "web_worker.js") }),
  build({ ...common, entryPoints: ["src/web/sw.ts"], format: "iife", outfile: join(folder, "web_offline.js") }),
  build({ ...common, entryPoints: ["src/web/web.css"], outfile: join(folder, "web.css") }),
  build({ ...common, entryPoints: ["src/live/live.css"], outfile: join(folder, "live.css") }),
  build({ ...common, entryPoints: ["src/mount.ts"], format: "esm", outfile: join(folder, "linkwork.js") }),
  build({
    ...common,
    entryPoints: ["src/widget.ts"],
    format: "esm",
    loader: { ".css": "text" },
    outfile: join(folder, "widget.js"),
  }),
  build({ ...common, entryPoints: ["src/page.css"], outfile: join(folder, "linkwork.css") }),
]);
