// Real reports in a real browser: those that make.js made with the program.
import test, { before, after } from "node:test";
import assert from "node:assert/strict";
import { stat } from "node:fs/promises";
import path from "node:path";
import { launch, open, real } from "./browser.js";
import { DRIVE, GNSS, MODEL } from "./hostile.js";
import { coloured, download, drag, parseCsv, settled, tool } from "./page.js";

const NAMES = ["demo", "navigate", "outages", "compare"];
const from = { folder: real };
let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

const phone = { ...from, viewport: { width: 400, height: 800 }, deviceScaleFactor: 2, isMobile: true, hasTouch: true };
const ranges = (page, n) => page.evaluate(n => (({ x, y }) => [x.min, x.max, y.min, y.max])(report.plots[n].u.scales), n);
// The first plot of a figure that is drawn over time.
const firstOverTime = page => page.evaluate(() => report.plots.findIndex(plot => /^time/.test(plot.panel.x.label)));
async function areaOf(page, n) {
  await page.evaluate(n => report.plots[n].u.over.scrollIntoView({ block: "center" }), n);
  await settled(page);
  return page.evaluate(n => (r => ({ x: r.x, y: r.y, width: r.width, height: r.height }))(report.plots[n].u.over.getBoundingClientRect()), n);
}

for (const name of NAMES) {
  test(`${name}: drawn in light and dark, without errors or requests`, async () => {
    for (const colorScheme of ["light", "dark"]) {
      const { page, troubles, close } = await open(browser, name, { ...from, colorScheme });
      const counts = await coloured(page);
      assert.ok(counts.length >= 3, String(counts.length));
      counts.forEach(({ title, count }, i) => assert.ok(count > 100, `plot ${i} ${title} has ${count} pixels`));
      assert.equal(await page.locator("section").count(), await page.locator("nav li").count());
      // Every axis says what it shows, but those of names.
      const bare = await page.evaluate(() => report.plots.filter(({ panel: { x, y } }) => !y.label || !x.label && !x.names.length).length);
      assert.equal(bare, 0);
      assert.deepEqual(troubles, []);
      await close();
    }
  });

  test(`${name}: no text shows a number that is not finite`, async () => {
    const { page, close } = await open(browser, name, from);
    const text = await page.evaluate(() => document.querySelector("main").innerText);
    assert.doesNotMatch(text, /\b(NaN|undefined|null|Infinity|inf)\b/);
    await close();
  });

  test(`${name}: numbers stand at the right, tables are saved with as many cells in every row`, async () => {
    const { page, close } = await open(browser, name, from);
    const tables = await page.locator("[data-table]").count();
    for (let i = 0; i < Math.min(tables, 6); i++) {
      const left = await page.evaluate(i => {
        const rows = Array.from(document.querySelectorAll("[data-table]")[i].querySelectorAll("tbody tr"), row => Array.from(row.cells));
        const cells = rows[0].map((_, c) => rows.map(row => row[c]));
        return cells.slice(1).filter(column => column.every(cell => /^[−±<]?\s?\d[\d\s.]*$/.test(cell.textContent) && !cell.classList.contains("number"))).length;
      }, i);
      assert.equal(left, 0, `table ${i + 1}`);
      const { text } = await download(page, () => tool(page, `table-${i + 1}`, "CSV").click());
      const rows = parseCsv(text);
      for (const row of rows) assert.equal(row.length, rows[0].length);
      for (const cell of rows.flat()) assert.ok(!/^[=+\-@]/.test(cell) || isFinite(cell), cell);
      assert.doesNotMatch(text, /[\u202f−]\d/);
    }
    await close();
  });

  test(`${name}: zooms by mouse, keys and finger`, async () => {
    const { page, troubles, close } = await open(browser, name, from);
    const n = await firstOverTime(page), before = await ranges(page, n);
    const reset = () => page.evaluate(n => report.plots[n].reset.hidden, n);
    const box = await areaOf(page, n);
    await drag(page, box, [0.3, 0.5], [0.6, 0.5]);
    const zoomed = await ranges(page, n);
    assert.ok(zoomed[1] - zoomed[0] < 0.32 * (before[1] - before[0]) && !(await reset()));
    await page.evaluate(n => report.plots[n].reset.click(), n);
    assert.deepEqual(await ranges(page, n), before);
    await page.evaluate(n => report.plots[n].u.root.focus(), n);
    await page.keyboard.press("+");
    const half = await ranges(page, n);
    assert.ok(Math.abs((half[1] - half[0]) / (before[1] - before[0]) - 0.5) < 0.01);
    await page.keyboard.press("ArrowRight");
    assert.ok((await ranges(page, n))[0] > half[0]);
    await page.keyboard.press("0");
    assert.deepEqual(await ranges(page, n), before);
    assert.deepEqual(troubles, []);
    await close();

    const small = await open(browser, name, phone);
    const m = await firstOverTime(small.page), all = await ranges(small.page, m), at = await areaOf(small.page, m);
    const touch = await small.page.context().newCDPSession(small.page);
    const finger = (type, x) => touch.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x: at.x + x * at.width, y: at.y + at.height / 2 }] });
    await finger("touchStart", 0.2);
    for (const x of [0.25, 0.35, 0.5, 0.6]) await finger("touchMove", x);
    await finger("touchEnd");
    await settled(small.page);
    const part = await ranges(small.page, m), share = (part[1] - part[0]) / (all[1] - all[0]);
    assert.ok(share > 0.3 && share < 0.5, String(share));
    await small.page.locator(".reset:visible").first().click();
    assert.deepEqual(await ranges(small.page, m), all);
    assert.deepEqual(small.troubles, []);
    await small.close();
  });

  test(`${name}: a series is hidden and shown`, async () => {
    const { page, close } = await open(browser, name, from);
    const n = await page.evaluate(() => report.plots.findIndex(plot => plot.panel.series.filter(s => s.name).length > 1));
    const hidden = () => page.evaluate(n => report.plots[n].panel.series.filter(s => s.hidden).length, n);
    const button = page.locator(".panel").nth(n).locator(".legend button").first();
    await button.click();
    assert.ok(await hidden() > 0);
    await button.click();
    assert.equal(await hidden(), 0);
    await close();
  });

  test(`${name}: on a phone nothing scrolls sideways but tables`, async () => {
    const { page, troubles, close } = await open(browser, name, phone);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 400);
    const wide = await page.evaluate(() => Array.from(document.querySelectorAll("h1, h2, h3, p, .tools button, .caption, .plot"), e => e.getBoundingClientRect()).filter(r => r.right > 401 || r.left < -1).length);
    assert.equal(wide, 0);
    assert.deepEqual(troubles, []);
    await close();
  });

  test(`${name}: on paper every panel is lines`, async () => {
    const { page, close } = await open(browser, name, { ...from, colorScheme: "dark" });
    await page.emulateMedia({ media: "print" });
    await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
    assert.equal(await page.locator(".paper:visible").count(), await page.evaluate(() => report.plots.length));
    assert.equal(await page.locator("button:visible, canvas:visible").count(), 0);
    await close();
  });
}

test("hostile names of files, columns and models are text", async () => {
  for (const name of ["navigate", "outages", "compare"]) {
    const { page, troubles, close } = await open(browser, name, from);
    assert.equal(await page.locator("main img, main svg[onload], main image, header img, header svg").count(), 0);
    assert.equal(await page.locator("script").count(), 2);
    const text = await page.evaluate(() => document.body.textContent);
    assert.ok(text.includes(GNSS) && text.includes(MODEL), name);
    if (name !== "compare") assert.ok((await page.title()).includes(DRIVE));
    else assert.ok((await page.locator(".legend").first().textContent()).includes(`random-walk${DRIVE}`));
    assert.deepEqual(troubles, []);
    await close();
  }
});

test("an outlier and a gap are seen", async () => {
  const { page, close } = await open(browser, "navigate", from);
  const seen = await page.evaluate(() => ({
    left: report.plots.some(plot => plot.panel.series.some(s => s.name === "rejected" && s.x.length > 3)),
    // No line through the 40 s without fixes.
    bridged: report.plots.filter(plot => /σ\]$/.test(plot.panel.y.label) && / (north|east|down) \[/.test(plot.panel.y.label))
      .flatMap(plot => plot.panel.series.filter(s => ["thin", "line", "thick"].includes(s.style)))
      .filter(s => Array.from(s.x).some((x, i) => i && x - s.x[i - 1] > 35 && s.y[0][i] != null && s.y[0][i - 1] != null)).length,
    shades: report.plots[0].panel.shades,
  }));
  assert.ok(seen.left);
  assert.equal(seen.bridged, 0);
  assert.ok(seen.shades.some(([from, to]) => Math.abs(to - from - 40) <= 3), JSON.stringify(seen.shades));
  await close();
});

test("an hour at 200 Hz is small and opens within two seconds", async () => {
  const { size } = await stat(path.join(real, "hour.html"));
  assert.ok(size < 5e6, String(size));
  const { page, troubles, close } = await open(browser, "hour", from);
  const { ready, drawn } = await page.evaluate(() => ({ ready: report.ready, drawn: report.plots.every(plot => plot.drawn > 0) }));
  assert.ok(drawn && ready < 2000, `${ready} ms`);
  assert.deepEqual(troubles, []);
  console.log(`# hour.html: ${(size / 1e6).toFixed(1)} MB, drawn after ${Math.round(ready)} ms`);
  await close();
});
