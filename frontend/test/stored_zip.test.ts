import { execFileSync } from "node:child_process";
import { expect, test } from "vitest";
import { storedEntries } from "../src/web/stored_zip";

const WRITE = `
import io, sys, zipfile
content = io.BytesIO()
with zipfile.ZipFile(content, "w") as archive:
    archive.writestr("a/é.py", "x = 1")
    archive.writestr("empty", "")
with zipfile.ZipFile(content, "a") as archive:
    archive.writestr(zipfile.ZipInfo("b.pyc"), bytes(range(256)))
sys.stdout.buffer.write(content.getvalue())
`;

test("an archive written in two goes is read file by file", () => {
  const written = execFileSync("python3", ["-c", WRITE]);
  const archive = new Uint8Array(written).buffer;
  const found = [...storedEntries(archive)];
  expect(found.map((entry) => entry.name)).toEqual(["a/é.py", "empty", "b.pyc"]);
  expect(found.map((entry) => entry.content.length)).toEqual([5, 0, 256]);
  expect(new TextDecoder().decode(found[0]!.content)).toBe("x = 1");
  expect(found[2]!.content[255]).toBe(255);
});
