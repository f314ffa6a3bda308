// What the program writes as GLB has neither error nor warning by Khronos's glTF validator.
import assert from "node:assert/strict";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { test } from "node:test";
import validator from "gltf-validator";
import { file, folder, run } from "./support.mjs";

run("expand", "builtin:cow@1", "--of", "stretch", "--lmax", "8", "-q", "-o", file("cow.json"));
run("reconstruct", file("cow.json"), "--order", "0,1,8", "-q", "-o", file("order-{}.glb"));
run("reconstruct", file("cow.json"), "--order", "5", "--fields", "f", "--mesh", "builtin:cow@1", "-q", "-o", file("f-{}.glb"));
run("map", "builtin:cow@1", "-q", "-o", file("map.glb"));
run("map", "builtin:cow@1", "--method", "flow", "-q", "-o", file("flow.glb"));
run("inflate", "builtin:cow@1", "--levels", "0.05,star", "--cells", "24", "-q", "-o", file("inflated-{}.glb"));

// Far from its origin, so that the writer moves it; one vertex is no triangle's; the name is no plain text.
const corners = [
  [1, 0, 0],
  [-1, 0, 0],
  [0, 1, 0],
  [0, -1, 0],
  [0, 0, 1],
  [0, 0, -1],
  [3, 3, 3],
];
const faces = ["0 2 4", "2 1 4", "1 3 4", "3 0 4", "2 0 5", "1 2 5", "3 1 5", "0 3 5"];
const places = corners.map((corner) => corner.map((value) => value + 1e6).join(" "));
writeFileSync(file('a "b" \u00e9.off'), ["OFF", "7 8 0", ...places, ...faces.map((face) => `3 ${face}`), ""].join("\n"));
run("map", file('a "b" \u00e9.off'), "-q", "-o", file("far.glb"));

const written = readdirSync(folder).filter((name) => name.endsWith(".glb"));

test("all of the commands wrote their files", () => assert.equal(written.length, 9));

for (const name of written)
  test(`${name} is valid`, async () => {
    const report = await validator.validateBytes(new Uint8Array(readFileSync(file(name))), { uri: name, maxIssues: 20 });
    const { issues } = report;
    const said = issues.messages.map(({ code, message, pointer }) => `${code} ${pointer}: ${message}`).join("\n");
    assert.deepEqual([issues.numErrors, issues.numWarnings], [0, 0], said);
    assert.ok(report.info.totalTriangleCount >= 8);
    if (said) console.log(`${name}: ${said}`);
  });

test("the validator sees what is wrong", async () => {
  const bytes = new Uint8Array(readFileSync(file("order-0.glb")));
  bytes.fill(0xff, bytes.length - 400, bytes.length - 360); // indices beyond the vertices, or normals that are no numbers
  const { issues } = await validator.validateBytes(bytes);
  assert.ok(issues.numErrors > 0);
});
