// Bundles src/ and index.html into one page without data: node build.mjs OUT.html
// Styles and script are inside, and the policy names their hashes, so nothing else runs and nothing is fetched.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, renameSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? "report.html";
const target = "es2020";

async function bundled(options) {
  const result = await build({
    absWorkingDir: here,
    bundle: true,
    minify: true,
    write: false,
    metafile: true,
    legalComments: "none",
    target,
    ...options,
  });
  return [result.outputFiles[0].text.trim(), Object.keys(result.metafile.inputs)];
}

/// The licences of the packages that these files are from, which copies of them must carry.
function licences(files) {
  const names = new Set(files.flatMap((file) => /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(file)?.[1] ?? []));
  return [...names].sort().map((name) => {
    const { version, license } = JSON.parse(readFileSync(`${here}/node_modules/${name}/package.json`, "utf8"));
    return `${name} ${version} (${license})\n\n${readFileSync(`${here}/node_modules/${name}/LICENSE`, "utf8").trim()}\n`;
  });
}

// In the page the text of a script may not hold its end tag, and replacement strings not `$`.
const [code, files] = await bundled({ entryPoints: ["src/main.js"], format: "iife", charset: "ascii" });
const script = code.replaceAll("</script", "<\\/script");
const [style] = await bundled({ entryPoints: ["src/style/all.css"] });
const hash = (text) => `sha256-${createHash("sha256").update(text).digest("base64")}`;
const parts = {
  script,
  style,
  "script-hash": hash(script),
  "style-hash": hash(style),
  licences: licences(files).join("\n\n").replaceAll("</", "< /"),
};
const page = readFileSync(`${here}/index.html`, "utf8").replace(
  /@(script|style|script-hash|style-hash|licences)@/g,
  (place) => parts[place.slice(1, -1)],
);

mkdirSync(dirname(out), { recursive: true });
writeFileSync(`${out}.part`, page);
renameSync(`${out}.part`, out);
console.log(`${out}: ${page.length} bytes, script ${script.length}, style ${style.length}`);
