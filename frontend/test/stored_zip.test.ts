import { execFileSync } from "node:child_process";
import { expect, test } from "vitest";
import { StoredZip } from "../src/web/stored_zip";

const WRITE = `
import io, sys, zipfile
content = io.BytesIO()
with zipfile.ZipFile(content, "w") as archive:
    archive.writestr("a/é.py", "x = 1")
    archive.writestr("empty", "")
    archive.writestr(zipfile.ZipInfo("b.pyc"), bytes(range(256)))
sys.stdout.buffer.write(content.getvalue())
`;

test("an archive is read file by file and part by part", async () => {
  const written = execFileSync("python3", ["-c", WRITE]);
  const archive = new StoredZip(new Blob([new Uint8Array(written)]));
  await archive.bringIn();
  const found = await archive.entries();
  expect([...found].map(([name, { size }]) => [name, size])).toEqual([["a/é.py", 5], ["empty", 0], ["b.pyc", 256]]);
  expect(new TextDecoder().decode(found.get("a/é.py")!.read())).toBe("x = 1");
  expect([...new Uint8Array(found.get("b.pyc")!.slice(254, 300).read())]).toEqual([254, 255]);
});
