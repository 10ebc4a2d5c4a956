// Pictures of reports for the documentation: `node screenshots.js DIR`, where demo.html, navigate.html and outages.html are: the
// demo's report, and those of the sample drive (`undrift sample`).
import { mkdir } from "node:fs/promises";
import path from "node:path";
import { launch, open } from "./browser.js";
import { settled } from "./page.js";

const folder = path.resolve(process.argv[2]);
const images = path.resolve(import.meta.dirname, "../../docs/img");
await mkdir(images, { recursive: true });
const browser = await launch();

async function picture(name, report, { width = 1200, colorScheme = "light", act = () => {}, clip }) {
  const { page, close } = await open(browser, report, { folder, colorScheme, viewport: { width, height: 900 } });
  await act(page);
  await settled(page);
  const { y, height } = await clip(page);
  await page.screenshot({ path: path.join(images, name), fullPage: true, clip: { x: 0, y, width, height } });
  await close();
}

const edge = (page, selector, side) => page.evaluate(([selector, side]) => document.querySelector(selector).getBoundingClientRect()[side] + scrollY, [selector, side]);
const upTo = selector => async page => ({ y: 0, height: Math.ceil(await edge(page, selector, "bottom")) + 16 });
const between = (from, to) => async page => {
  const y = Math.floor(await edge(page, from, "top")) - 8;
  return { y, height: Math.ceil(await edge(page, to, "bottom")) + 16 - y };
};
// A cursor in the middle of the first plot over time of a log.
const cursor = page => page.evaluate(() => {
  const { u } = report.plots.find(plot => plot.linked && !plot.panel.scale);
  u.setCursor({ left: u.over.clientWidth / 2, top: u.over.clientHeight / 2 });
});
// The stretch around an outage on the map.
const outage = page => page.evaluate(() => {
  const plot = report.plots.find(plot => plot.panel.scale), cut = plot.panel.series.filter(s => s.style === "thick")[1];
  plot.setZoom(plot.placesIn(cut.t[0], cut.t.at(-1)));
});

await picture("report-demo.png", "demo", { clip: upTo("#table-1") });
await picture("report-demo-dark.png", "demo", { colorScheme: "dark", clip: upTo("#table-1") });
await picture("report-outages.png", "outages", { clip: between("#figure-1", "#figure-2") });
await picture("report-navigate.png", "navigate", { width: 1400, act: cursor, clip: upTo("#figure-1") });
await picture("report-navigate-dark.png", "navigate", { width: 1400, colorScheme: "dark", act: cursor, clip: between("#figure-3", "#figure-3") });
await picture("report-phone.png", "outages", { width: 390, clip: upTo("#figure-2") });
await picture("report-map.png", "outages", { width: 1000, act: outage, clip: between("#figure-4", "#figure-4") });
await browser.close();
