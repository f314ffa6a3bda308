// What the program writes as GLB has neither error nor warning by Khronos's glTF validator.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";
import validator from "gltf-validator";
import { file, folder, run } from "./support.mjs";

run("expand", "builtin:cow@1", "--of", "stretch", "--lmax", "8", "-q", "-o", file("cow.json"));
run("reconstruct", file("cow.json"), "--order", "0,1,8", "-q", "-o", file("order-{}.glb"));
run("reconstruct", file("cow.json"), "--order", "5", "--fields", "f", "--mesh", "builtin:cow@1", "-q", "-o", file("f-{}.glb"));
run("map", "builtin:cow@1", "-q", "-o", file("map.glb"));
run("map", "builtin:cow@1", "--method", "flow", "-q", "-o", file("flow.glb"));
run("inflate", "builtin:cow@1", "--levels", "0.05,star", "--cells", "24", "-q", "-o", file("inflated-{}.glb"));

const written = readdirSync(folder).filter((name) => name.endsWith(".glb"));

test("all of the commands wrote their files", () => assert.equal(written.length, 8));

for (const name of written)
  test(`${name} is valid`, async () => {
    const report = await validator.validateBytes(new Uint8Array(readFileSync(file(name))), { uri: name, maxIssues: 20 });
    const { issues } = report;
    const said = issues.messages.map(({ code, message, pointer }) => `${code} ${pointer}: ${message}`).join("\n");
    assert.deepEqual([issues.numErrors, issues.numWarnings], [0, 0], said);
    assert.ok(report.info.totalTriangleCount > 100);
    if (said) console.log(`${name}: ${said}`);
  });
