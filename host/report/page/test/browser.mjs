// The page in headless Chromium, opened as a file: it draws, follows slider and pointer, is accessible, asks for nothing.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import {
  choose,
  clickHead,
  launch,
  mark,
  middle,
  onMap,
  open as openIn,
  order,
  picture,
  pixel,
  pixelsLike,
  red,
  settled,
  words,
} from "./pages.mjs";
import { file, json, print, run } from "./support.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const hostile = "</script><script>window.broken = 1</script><img src=x onerror='window.broken = 2'>";
let browser;
const open = (name, options) => openIn(browser, name, options);

before(async () => {
  run("expand", "builtin:cow@1", "--of", "mass,stretch,harmonic", "--lmax", "12", "-q", "-o", file("cow.json"));
  writeFileSync(file("tensors.json"), print("tensors", "builtin:cow@1", "--json"));
  const findings = {
    schema: "cowgpu.tip.v1",
    program: { name: "cowgpu", version: "0" },
    command: ["cowgpu", "tip", hostile],
    created: "",
    input: { kind: "mesh", name: hostile },
    notes: [hostile],
    [hostile]: hostile,
    torque: null,
    units: { torque: "N m" },
    orders: {
      columns: ["order", "error", "word"],
      units: ["", "m", ""],
      rows: [
        [2, 0.5, hostile],
        [10, null, "b"],
        [1, 1e-9, "a"],
      ],
    },
  };
  writeFileSync(file("tip.json"), JSON.stringify(findings));
  run(
    "report",
    file("cow.json"),
    "--mesh",
    "builtin:cow@1",
    "--physics",
    file("tensors.json"),
    "--physics",
    file("tip.json"),
    "-q",
    "-o",
    file("cow.html"),
  );
  const renamed = json("cow.json");
  renamed.mesh.name = hostile;
  renamed.notes = [hostile];
  renamed.command.push(hostile);
  renamed.timings.total = null;
  writeFileSync(file("hostile.json"), JSON.stringify(renamed));
  writeFileSync(file("marked.json"), "\ufeff" + JSON.stringify(findings)); // a byte order mark
  writeFileSync(file("odd.json"), JSON.stringify({ ...findings, paper: [null] }));
  run("report", file("hostile.json"), "--physics", file("marked.json"), "-q", "-o", file("hostile.html"));
  run("report", file("hostile.json"), "--physics", file("odd.json"), "--physics", file("tip.json"), "-q", "-o", file("odd.html"));
  run("expand", "builtin:box:1,2,3", "--lmax", "6", "-q", "-o", file("box.json"));
  run("report", file("box.json"), "-q", "-o", file("box.html"));
  run("report", file("box.json"), "--mesh", "builtin:box:1,2,3", "-q", "-o", file("box-mesh.html"));
  const faces = json("cow.json").mesh.faces;
  const names = ["id", "x", "y", "z", "g_x", "g_y", "g_z", "slope"];
  const rows = Array.from({ length: faces }, (_, i) => [i, 0.5, 0, 0, 0, -2, 0, i / 100].join(","));
  writeFileSync(file("values.csv"), [names.join(","), ...rows, ""].join("\n"));
  writeFileSync(
    file("values.csv.json"),
    JSON.stringify({
      schema: "cowgpu.values.v1",
      body: hostile,
      place: "faces",
      rows: faces,
      columns: names.map((name) => ({ name, unit: name === "slope" ? "deg" : "m", meaning: hostile })),
      notes: [hostile],
    }),
  );
  const valuesOf = (result, page) =>
    run("report", file(result), "--mesh", "builtin:cow@1", "--values", file("values.csv"), "-q", "-o", file(page));
  valuesOf("cow.json", "values.html");
  run("expand", "builtin:cow@1", "--lmax", "6", "-q", "-o", file("mass.json"));
  valuesOf("mass.json", "values-alone.html");
  browser = await launch();
});

after(() => browser?.close());

test("it opens without a word on the console and without a request", async () => {
  const page = await open("cow.html");
  for (const tab of ["coefficients", "physics", "provenance", "spectra"]) await page.click(`#tab-${tab}`);
  await page.click("#ghost");
  await page.select("#surface", "harmonic");
  await settled(page);
  assert.deepEqual(page.said, []);
  assert.deepEqual(
    page.asked.filter((url) => !url.startsWith("data:")),
    [page.url()],
  );
  assert.equal(await page.$eval("#body", (body) => body.dataset.by), "webgl");
  await page.close();
});

test("values on the mesh are shown in colours, with the numbers of the place that is named or pointed at", async () => {
  for (const name of ["values.html", "values-alone.html"]) {
    const page = await open(name, { height: 1800 });
    assert.equal(await page.$eval("#stage", (stage) => stage.hidden), name === "values-alone.html");
    assert.match(await words(page, "#values-bar"), /slope \(\u00b0\)/);
    await page.$eval("#values-number", (box) => {
      box.value = 1234;
      box.dispatchEvent(new Event("change"));
    });
    const said = await words(page, "#values-readout");
    assert.match(said, /slope12.340\u00b0/);
    assert.match(said, /g \(x, y, z\)\(0, \u22122, 0\) m/);
    assert.match(said, /place\(0.50000, 0, 0\) m/);
    const before = await picture(page, "#values-body");
    await choose(page, "#quantity", "0");
    assert.match(await words(page, "#values-bar"), /size of g \(m\)2/);
    assert.notEqual(await picture(page, "#values-body"), before);
    const box = await (await page.$("#values-body canvas")).boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await settled(page);
    assert.match(await page.$eval("#values-readout", (readout) => readout.dataset.place), /^\d+$/);
    await page.mouse.move(box.x + 3, box.y + 3);
    await settled(page);
    assert.match(await words(page, "#values-readout"), /Point at the body/);
    assert.deepEqual(page.said, []);
    assert.equal(await page.evaluate(() => window.broken), undefined);
    await page.close();
  }
});

test("its policy forbids what it does not need", async () => {
  const page = await open("cow.html");
  const refused = await page.evaluate(async () => {
    const tries = [
      fetch("https://example.invalid/").then(
        () => "fetched",
        () => "refused",
      ),
    ];
    const script = document.createElement("script");
    script.textContent = "window.injected = true";
    document.body.append(script);
    return [...(await Promise.all(tries)), window.injected ?? "refused"];
  });
  assert.deepEqual(refused, ["refused", "refused"]);
  assert.ok(
    page.said.some((line) => /Content Security Policy/.test(line)),
    page.said.join("\n"),
  );
  await page.close();
});

test("the slider moves the body and the map, between orders too, and by keys", async () => {
  const page = await open("cow.html");
  const seen = new Set();
  for (const value of [0, 1, 2, 2.5, 3, 12]) {
    await order(page, value);
    seen.add(await picture(page, "#body"));
    assert.equal(Number(await page.$eval("#order-number", (box) => box.value)), value);
  }
  assert.equal(seen.size, 6);
  const before = await picture(page, "#map");
  await page.$eval("#order", (slider) => {
    slider.value = 300;
    slider.dispatchEvent(new Event("input"));
  });
  await settled(page);
  assert.notEqual(await picture(page, "#map"), before);
  await page.focus("#order");
  await page.keyboard.press("Home");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  await settled(page);
  assert.match(await words(page, "#order-name"), /^order 2: to the quadrupole . distance to the mesh 0\.\d+ rms/);
  assert.equal(await page.$eval("#order", (slider) => slider.getAttribute("aria-valuetext")), "order 2: to the quadrupole");
  await page.keyboard.press("End");
  assert.match(await words(page, "#order-name"), /^order 12/);
  await page.close();
});

test("maps, fields and components change what is drawn", async () => {
  const page = await open("cow.html");
  await order(page, 12);
  const seen = new Set([await picture(page, "#body")]);
  for (const [select, value] of [
    ["#component", "f_dphi"],
    ["#component", "distance"],
    ["#shape", "f"],
    ["#surface", "harmonic"],
  ]) {
    await choose(page, select, value);
    seen.add(await picture(page, "#body"));
  }
  assert.equal(seen.size, 5);
  await choose(page, "#component", "x");
  const without = await picture(page, "#body");
  await page.click("#ghost");
  await settled(page);
  assert.notEqual(await picture(page, "#body"), without);
  assert.match(await words(page, "#bar"), /^x \(mesh unit\)/);
  await page.close();
});

test("a point of the body is marked on the map, and a point of the map on the body", async () => {
  const page = await open("cow.html");
  await order(page, 12);
  assert.equal(await mark(page), null);
  assert.equal(await pixelsLike(page, "#map", red), 0);
  await page.mouse.move(...(await middle(page, "#body")));
  await settled(page);
  const there = await mark(page);
  assert.ok(there, "the middle of the picture is the body");
  assert.ok((await pixelsLike(page, "#map", red)) > 20);
  const onBody = await picture(page, "#body");
  const values = await words(page, "#readout");

  // The map at the same direction marks the same place, up to a pixel.
  await page.mouse.move(...(await onMap(page, there)));
  await settled(page);
  const again = await mark(page);
  assert.ok(Math.abs(again[0] - there[0]) < 0.01 && Math.abs(again[1] - there[1]) < 0.02, `${there} and ${again}`);
  assert.ok((await pixelsLike(page, "#body", red)) > 20);
  const value = (text) => Number(text.match(/f_r(\d\.\d+)/)[1]);
  assert.ok(Math.abs(value(await words(page, "#readout")) - value(values)) < 0.02);

  await page.mouse.move(...(await onMap(page, [0.8, 1.9])));
  await settled(page);
  const other = await mark(page);
  assert.ok(Math.abs(other[0] - 0.8) < 0.01 && Math.abs(other[1] - 1.9) < 0.01, `${other}`);
  assert.notEqual(await picture(page, "#body"), onBody);
  await page.mouse.move(5, 5);
  await settled(page);
  assert.equal(await mark(page), null);
  assert.equal(await pixelsLike(page, "#map", red), 0);
  await page.close();
});

test("the map's colour is the bar's for the value that is read out", async () => {
  const page = await open("cow.html");
  await order(page, 12);
  await page.click("#graticule");
  for (const direction of [
    [0.8, 1.9],
    [1.6, 0.3],
    [2.3, 5.1],
    [1.2, 3.6],
  ]) {
    const [x, y] = await onMap(page, direction);
    await page.mouse.move(x, y);
    await settled(page);
    const value = await page.$$eval("#readout dd", (all) => Number(all[2].textContent.split(" ")[0]));
    const [low, high] = await page.$$eval(".bar-ticks span", (all) =>
      [all[0], all.at(-1)].map((tick) => Number(tick.textContent)),
    );
    const wanted = await pixel(page, "#bar", [Math.round((255 * (value - low)) / (high - low)), 0]);
    const box = await (await page.$("#map canvas")).boundingBox();
    const found = await pixel(page, "#map", [x - box.x, y - box.y]);
    // The colours of the map are a raster of 720 pixels; a value's step there is a few of 256 colours.
    assert.ok(
      wanted.every((part, c) => Math.abs(part - found[c]) <= 12),
      `${direction}: ${wanted} and ${found}`,
    );
  }
  await page.close();
});

test("keys turn the body, move the point, and screen readers hear of it", async () => {
  const page = await open("cow.html");
  await page.focus("#body canvas");
  const before = await picture(page, "#body");
  await page.keyboard.press("ArrowLeft");
  await settled(page);
  assert.notEqual(await picture(page, "#body"), before);
  await page.waitForFunction(() => /azimuth/.test(document.getElementById("live").textContent));
  await page.focus("#map canvas");
  for (const key of ["ArrowRight", "ArrowRight", "ArrowDown"]) await page.keyboard.press(key);
  await settled(page);
  const [theta, phi] = await mark(page);
  assert.ok(Math.abs(theta - (95 * Math.PI) / 180) < 1e-4 && Math.abs(phi - (5 * Math.PI) / 180) < 1e-4, `${theta} ${phi}`);
  await page.waitForFunction(() => /95\.0\u00b0, 5\.0\u00b0/.test(document.getElementById("live").textContent));
  await page.focus("#tab-spectra");
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.evaluate(() => document.activeElement.id), "tab-coefficients");
  assert.equal(await page.$eval("#panel-coefficients", (panel) => panel.hidden), false);
  await page.close();
});

test("tables sort, and copy every digit", async () => {
  const page = await open("cow.html");
  await page.evaluate(() =>
    Object.defineProperty(navigator, "clipboard", { value: { writeText: async (text) => void (window.copied = text) } }),
  );
  await page.click("#tab-coefficients");
  await clickHead(page, "#panel-coefficients", "Re f_r");
  await page.click("#panel-coefficients .copy");
  await page.waitForFunction(() => window.copied);
  const lines = (await page.evaluate(() => window.copied))
    .trimEnd()
    .split("\n")
    .map((line) => line.split("\t"));
  assert.deepEqual(lines[0].slice(0, 4), ["l", "m", "Re f_r", "Im f_r"]);
  const rows = lines.slice(1).map((line) => line.map(Number));
  assert.equal(rows.length, 15);
  rows.slice(1).forEach((row, i) => assert.ok(row[2] >= rows[i][2]));
  const known = new Map(json("cow.json").expansions.stretch.coefficients.map((row) => [`${row[0]} ${row[1]}`, row]));
  for (const row of rows)
    assert.deepEqual(
      row.slice(2),
      known
        .get(`${row[0]} ${row[1]}`)
        .slice(2, 8)
        .map((value) => value + 0),
    );
  await clickHead(page, "#panel-coefficients", "Re f_r");
  const largest = await page.$eval("#panel-coefficients tbody tr", (row) =>
    [...row.children].slice(0, 2).map((cell) => Number(cell.textContent)),
  );
  assert.deepEqual(largest, rows.at(-1).slice(0, 2));
  assert.equal(await page.$eval("#panel-coefficients [aria-sort=descending]", (head) => head.textContent), "Re f_r");

  await page.click("#tab-physics");
  await clickHead(page, "#panel-physics .findings:last-of-type", "error");
  const errors = await page.$$eval("#panel-physics .findings:last-of-type tbody tr td:nth-child(2)", (cells) =>
    cells.map((cell) => cell.textContent),
  );
  assert.deepEqual(
    errors.map((text) => text === "not known"),
    [false, false, true],
  );
  assert.equal(errors[1], "0.500000");
  await page.close();
});

test("where the browser has no clipboard for pages, a selection is copied", async () => {
  const page = await open("cow.html");
  await page.evaluate(() => {
    Object.defineProperty(navigator, "clipboard", { value: undefined });
    document.addEventListener("copy", () => (window.copied = document.activeElement.value));
  });
  await page.click("#tab-provenance");
  await page.click("#panel-provenance .copy");
  await page.waitForFunction(() => window.copied);
  assert.match(
    await words(page, "#panel-provenance pre"),
    /d3-geo 3[^]*Mike Bostock[^]*three 0[^]*Permission is hereby granted/,
  );
  assert.match(await page.evaluate(() => window.copied), /expand builtin:cow@1 --of mass,stretch,harmonic --lmax 12/);
  await page.close();
});

test("axe-core finds nothing, on any tab, by day, by night, on a phone", async () => {
  const features = (scheme) => [{ name: "prefers-color-scheme", value: scheme }];
  const all = ["spectra", "coefficients", "physics", "provenance"];
  for (const [scheme, width, tabs] of [
    ["light", 1000, all],
    ["dark", 1000, all],
    ["light", 390, ["physics"]],
  ]) {
    const page = await open("cow.html", { features: features(scheme), width });
    await page.evaluate(axe);
    for (const tab of tabs) {
      await page.click(`#tab-${tab}`);
      await page.$$eval("details", (every) => every.forEach((one) => (one.open = true)));
      await page.mouse.move(...(await middle(page, "#map")));
      await settled(page);
      const { violations, passes } = await page.evaluate(() =>
        window.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"] }),
      );
      assert.deepEqual(
        violations.map(
          ({ id, nodes }) =>
            `${id}: ${nodes
              .map((node) => node.html)
              .join(" ")
              .slice(0, 400)}`,
        ),
        [],
        `${tab}, ${scheme}, ${width}`,
      );
      assert.ok(passes.length > 20);
    }
    await page.close();
  }
});

test("light and dark follow the system, and the button overrides it", async () => {
  const page = await open("cow.html", { features: [{ name: "prefers-color-scheme", value: "light" }] });
  const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const bright = (colour) => Math.max(...colour.match(/\d+/g).map(Number)) > 200;
  assert.ok(bright(await paper()));
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  assert.ok(!bright(await paper()));
  await page.click("#theme");
  assert.equal(await words(page, "#theme"), "Theme: light");
  assert.ok(bright(await paper()));
  await page.click("#theme");
  assert.ok(!bright(await paper()));
  await page.close();
});

test("playing goes through the orders; where motion is not welcome, by whole ones", async () => {
  for (const value of ["no-preference", "reduce"]) {
    const page = await open("cow.html", { features: [{ name: "prefers-reduced-motion", value }] });
    await page.evaluate(() => {
      window.orders = [];
      const box = document.getElementById("order-number");
      const slider = document.getElementById("order");
      new MutationObserver(() => window.orders.push(Number(box.value))).observe(slider, { attributes: true });
    });
    await order(page, 2);
    await page.click("#play");
    await page.waitForFunction(() => Number(document.getElementById("order-number").value) >= 4);
    await page.click("#play");
    const now = await page.$eval("#order-number", (box) => box.value);
    await settled(page);
    assert.equal(await page.$eval("#order-number", (box) => box.value), now);
    const seen = await page.evaluate(() => window.orders);
    assert.equal(seen.every(Number.isInteger), value === "reduce", String(seen));
    await page.close();
  }
});

test("nothing on the page is wider than a phone", async () => {
  const page = await open("cow.html", { width: 360, height: 740 });
  for (const tab of ["spectra", "coefficients", "physics", "provenance"]) {
    await page.click(`#tab-${tab}`);
    await settled(page);
    assert.ok((await page.evaluate(() => document.scrollingElement.scrollWidth)) <= 360, tab);
  }
  await page.close();
});

test("a document that cannot be shown leaves the others", async () => {
  const page = await open("odd.html");
  await page.click("#tab-physics");
  await settled(page);
  assert.match(await words(page, "#panel-physics"), /cannot be shown.*torquenot known N m/s);
  assert.deepEqual(page.said, []);
  await page.close();
});

test("names and notes with markup stay text", async () => {
  const page = await open("hostile.html");
  for (const tab of ["coefficients", "physics", "provenance"]) await page.click(`#tab-${tab}`);
  await settled(page);
  assert.equal(await words(page, "#title"), hostile);
  assert.equal(await page.title(), `${hostile} - cowgpu`);
  assert.equal(await page.evaluate(() => window.broken), undefined);
  assert.equal(await page.$$eval("img", (all) => all.length), 0);
  assert.deepEqual(page.said, []);
  assert.match(await words(page, "#panel-physics"), /torquenot known N m/);
  assert.match(await words(page, "#panel-provenance"), /distances tonot known/);
  assert.equal(await page.$$eval("#component option", (all) => all.some((one) => one.value === "distance")), false);
  await page.close();
});

test("a result without a surface has its spectra and tables, and the mesh where it is given", async () => {
  const page = await open("box.html");
  assert.deepEqual(page.said, []);
  assert.equal(await page.$eval("#controls", (part) => part.hidden), true);
  assert.ok((await page.$$("#panel-spectra path.line")).length === 1);
  await page.click("#tab-provenance");
  assert.match(await words(page, "#panel-provenance"), /no expansion of the surface/);
  await page.close();
  const shown = await open("box-mesh.html");
  assert.deepEqual(shown.said, []);
  const before = await picture(shown, "#body");
  await shown.focus("#body canvas");
  await shown.keyboard.press("ArrowRight");
  await settled(shown);
  assert.notEqual(await picture(shown, "#body"), before);
  await shown.close();
});

test("where there is no WebGL the body is drawn all the same, and says so", async () => {
  const plain = await launch({ webgl: false });
  try {
    const page = await openIn(plain, "cow.html");
    assert.equal(await page.$eval("#body", (body) => body.dataset.by), "software");
    assert.match(await words(page, "#body-panel"), /WebGL is not available/);
    assert.deepEqual(
      page.said.filter((line) => !/WebGL/.test(line)),
      [],
    ); // three.js says why
    const seen = new Set();
    for (const value of [0, 3, 12]) {
      await order(page, value);
      seen.add(await picture(page, "#body"));
    }
    assert.equal(seen.size, 3);
    await page.mouse.move(...(await middle(page, "#body")));
    await settled(page);
    assert.ok(await mark(page));
    assert.ok((await pixelsLike(page, "#body", red)) > 20);
    await page.click("#ghost");
    await settled(page);
    await page.close();
  } finally {
    await plain.close();
  }
});

test("a page without data says so", async () => {
  const page = await browser.newPage();
  await page.goto(pathToFileURL(`${process.env.COWGPU_PAGE}/report.html`).href);
  assert.match(await words(page, "#failure"), /holds no result/);
  await page.close();
});
