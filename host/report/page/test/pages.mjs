// Pages in headless Chromium, and what tests ask of them.
import { pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";
import { file } from "./support.mjs";

const patience = 240000; // the software renderer on a busy machine
const container = ["--no-sandbox", "--disable-dev-shm-usage"]; // as root, with little shared memory

/// A browser, whose WebGL is Chromium's software renderer, or that has none.
export const launch = ({ webgl = true } = {}) =>
  puppeteer.launch({
    executablePath: process.env.CHROMIUM,
    headless: true,
    args: [...container, ...(webgl ? ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"] : ["--disable-3d-apis"])],
    protocolTimeout: patience,
  });

/// A page, opened, with all that it said and asked for in page.said and page.asked.
export async function open(browser, name, { features = [], width = 1000, height = 800 } = {}) {
  const page = await browser.newPage();
  page.setDefaultTimeout(patience);
  page.said = [];
  page.asked = [];
  page.on("console", (message) => page.said.push(message.text()));
  page.on("pageerror", (error) => page.said.push(String(error)));
  page.on("request", (request) => page.asked.push(request.url()));
  await page.setViewport({ width, height });
  await page.emulateMediaFeatures(features);
  await page.goto(pathToFileURL(file(name)).href);
  await settled(page);
  return page;
}

/// Two frames later: what was to be drawn is drawn.
export const settled = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

export const picture = (page, of) => page.$eval(`${of} canvas`, (canvas) => canvas.toDataURL());
export const words = (page, of) => page.$eval(of, (element) => element.textContent);
export const mark = async (page) => {
  const text = await page.$eval("#readout", (element) => element.dataset.mark);
  return text ? text.split(" ").map(Number) : null;
};

export async function order(page, value) {
  await page.$eval(
    "#order-number",
    (box, to) => {
      box.value = to;
      box.dispatchEvent(new Event("input"));
    },
    value,
  );
  await settled(page);
}

export async function choose(page, select, value) {
  await page.select(select, value);
  await settled(page);
}

/// The colour [r, g, b] of a canvas at a point, in its css pixels; the window has one of the canvas's for each.
export const pixel = (page, of, at) =>
  page.$eval(
    `${of} canvas`,
    (canvas, [x, y]) => [...canvas.getContext("2d").getImageData(Math.floor(x), Math.floor(y), 1, 1).data].slice(0, 3),
    at,
  );

/// Colours of a canvas: how many of its pixels have one like `[r, g, b]`.
export const pixelsLike = (page, of, colour) =>
  page.$eval(
    `${of} canvas`,
    (canvas, wanted) => {
      const copy = document.createElement("canvas");
      [copy.width, copy.height] = [canvas.width, canvas.height];
      const context = copy.getContext("2d");
      context.drawImage(canvas, 0, 0);
      const { data } = context.getImageData(0, 0, copy.width, copy.height);
      let count = 0;
      for (let i = 0; i < data.length; i += 4)
        count += data[i + 3] > 200 && wanted.every((value, c) => Math.abs(data[i + c] - value) < 24);
      return count;
    },
    colour,
  );

export const red = [213, 68, 43]; // --marker by day

/// Where Mollweide's projection has a direction on the map's canvas, in css pixels of the window (Snyder 1987, p. 249).
export async function onMap(page, [theta, phi]) {
  const box = await (await page.$("#map canvas")).boundingBox();
  const radius = Math.min((box.width - 4) / 2, box.height - 4) / 2;
  const latitude = Math.PI / 2 - theta;
  let t = latitude;
  for (let k = 0; k < 100; ++k)
    t -= (2 * t + Math.sin(2 * t) - Math.PI * Math.sin(latitude)) / (2 + 2 * Math.cos(2 * t) + 1e-12);
  const longitude = phi > Math.PI ? phi - 2 * Math.PI : phi;
  return [
    box.x + box.width / 2 + (2 * radius * longitude * Math.cos(t)) / Math.PI,
    box.y + box.height / 2 - radius * Math.sin(t),
  ];
}

export const middle = async (page, of, right = 0.5, down = 0.5) => {
  const box = await (await page.$(`${of} canvas`)).boundingBox();
  return [box.x + right * box.width, box.y + down * box.height];
};

/// The button of a column whose head begins with `name`, clicked.
export const clickHead = (page, panel, name) =>
  page.$eval(
    panel,
    (element, wanted) =>
      [...element.querySelectorAll("thead button")].find((button) => button.textContent.startsWith(wanted)).click(),
    name,
  );
