// The program and files for the tests; page_check.sh says where they are.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export const folder = mkdtempSync(join(tmpdir(), "cowgpu-page-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

export const file = (name) => join(folder, name);
export const text = (name) => readFileSync(file(name), "utf8");
export const json = (name) => JSON.parse(text(name));

/// Runs the program; returns what it printed.
export const print = (...words) =>
  execFileSync(process.env.COWGPU_PROGRAM, words, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"], maxBuffer: 1e9 });
/// The same on the CPU path.
export const run = (...words) => print(...words, "--device", "cpu");

/// The data of a page that `cowgpu report` wrote.
export function dataOf(page) {
  const [, found] = page.match(/<script type="application\/json" id="data">([^<]*)<\/script>/);
  return found;
}
