// What the figures of a report have in common: one time, one zoom, the map; verdict, folds, names.
import test, { before, after } from "node:test";
import assert from "node:assert/strict";
import { launch, open, real } from "./browser.js";
import { drag, settled } from "./page.js";

const from = { folder: real };
let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

async function areaOf(page, n) {
  await page.evaluate(n => report.plots[n].u.over.scrollIntoView({ block: "center" }), n);
  await settled(page);
  return page.evaluate(n => (r => ({ x: r.x, y: r.y, width: r.width, height: r.height }))(report.plots[n].u.over.getBoundingClientRect()), n);
}
const find = (page, label) => page.evaluate(label => report.plots.findIndex(({ panel }) => panel.y.label.startsWith(label)), label);
const timed = page => page.evaluate(() => report.plots.flatMap(({ panel, linked }, i) => linked && !panel.scale ? [i] : []));
const range = (page, n) => page.evaluate(n => (({ x, y }) => [x.min, x.max, y.min, y.max])(report.plots[n].u.scales), n);
const wheel = async (page, deltaY) => { await page.mouse.wheel(0, deltaY); await settled(page); };

test("a cursor in one figure shows its time in all, and the place on the map", async () => {
  const { page, troubles, close } = await open(browser, "navigate", from);
  const plots = await timed(page), map = await find(page, "north [m]"), n = await find(page, "velocity east");
  assert.ok(plots.length > 15, String(plots.length));
  const box = await areaOf(page, n);
  await page.mouse.move(box.x + 0.4 * box.width, box.y + 0.5 * box.height);
  await settled(page);
  const seen = await page.evaluate(({ plots, map, n }) => {
    const { u } = report.plots[n], time = u.posToVal(u.cursor.left, "x");
    const { panel, marks, frame } = report.plots[map], way = panel.series.find(s => s.t && s.name === "solution");
    const i = way.t.findIndex(t => t >= time), at = report.plots[map].frame();
    const mark = marks[panel.series.indexOf(way)];
    return {
      texts: plots.map(p => report.plots[p].where.textContent), values: plots.map(p => report.plots[p].outputs.filter(Boolean).map(o => o.textContent)),
      expected: [at.x(way.x[i]), at.y(way.y[0][i])], mark: mark.style.transform.match(/[\d.]+/g).map(Number), hidden: mark.hidden,
      height: document.documentElement.scrollHeight,
    };
  }, { plots, map, n });
  assert.equal(new Set(seen.texts).size, 1, String(seen.texts));
  assert.match(seen.texts[0], /^time \[s\] \d/);
  assert.ok(seen.values.filter(v => v.length).every(v => v.some(text => /\d/.test(text))), JSON.stringify(seen.values));
  assert.ok(!seen.hidden && Math.hypot(seen.mark[0] - seen.expected[0], seen.mark[1] - seen.expected[1]) < 3, JSON.stringify(seen));
  // The page does not move when values come and go.
  await page.mouse.move(2, 2);
  await settled(page);
  assert.equal(await page.evaluate(() => document.documentElement.scrollHeight), seen.height);
  assert.ok((await page.evaluate(plots => plots.map(p => report.plots[p].where.textContent), plots)).every(text => text === ""));
  // From the map to the times.
  const ground = await areaOf(page, map);
  const [x, y, time] = await page.evaluate(map => {
    const plot = report.plots[map], at = plot.frame(), way = plot.panel.series.find(s => s.name === "solution"), i = way.t.length >> 1;
    return [at.x(way.x[i]), at.y(way.y[0][i]), way.t[i]];
  }, map);
  await page.mouse.move(ground.x + x, ground.y + y);
  await settled(page);
  const shown = await page.evaluate(n => Number(report.plots[n].where.textContent.replace("time [s] ", "")), n);
  assert.ok(Math.abs(shown - time) < 5, `${shown}, ${time}`);
  assert.deepEqual(troubles, []);
  await close();
});

test("a zoom in one figure zooms all over time, and the map to where it was", async () => {
  const { page, troubles, close } = await open(browser, "navigate", from);
  const plots = await timed(page), map = await find(page, "north [m]"), n = await find(page, "velocity east");
  const before = await Promise.all([...plots, map].map(p => range(page, p)));
  await drag(page, await areaOf(page, n), [0.4, 0.5], [0.6, 0.5]);
  const [start, end] = await range(page, n);
  for (const p of plots) {
    const [a, b] = await range(page, p);
    assert.ok(Math.abs(a - start) < 1e-6 && Math.abs(b - end) < 1e-6, `plot ${p}: ${a} to ${b}`);
  }
  const [west, east, south, north] = await range(page, map), whole = before[plots.length];
  assert.ok(east - west < 0.9 * (whole[1] - whole[0]));
  const out = await page.evaluate(({ map, start, end, area: [w, e, s, n] }) => {
    const way = report.plots[map].panel.series.find(s => s.name === "solution");
    return way.t.filter((t, i) => t >= start && t <= end && !(way.x[i] >= w && way.x[i] <= e && way.y[0][i] >= s && way.y[0][i] <= n)).length;
  }, { map, start, end, area: [west, east, south, north] });
  assert.equal(out, 0);
  // Zooming the map is its own business.
  await page.evaluate(map => report.plots[map].change(0.5), map);
  await settled(page);
  assert.deepEqual((await range(page, n)).slice(0, 2), [start, end]);
  const other = await areaOf(page, plots[0]);
  await page.mouse.dblclick(other.x + 30, other.y + 30);
  await settled(page);
  assert.deepEqual(await Promise.all([...plots, map].map(p => range(page, p))), before);
  assert.deepEqual(troubles, []);
  await close();
});

test("the wheel scrolls the page, zooms with Ctrl or where a plot has the focus; Shift and drag moves", async () => {
  const { page, troubles, close } = await open(browser, "navigate", from);
  const n = await find(page, "velocity east"), before = await range(page, n);
  let box = await areaOf(page, n);
  const top = await page.evaluate(() => scrollY);
  await page.mouse.move(box.x + 0.25 * box.width, box.y + 0.5 * box.height);
  await wheel(page, 100);
  assert.deepEqual(await range(page, n), before);
  assert.ok(await page.evaluate(() => scrollY) > top);
  box = await areaOf(page, n);
  await page.mouse.move(box.x + 0.25 * box.width, box.y + 0.5 * box.height);
  const under = () => page.evaluate(n => report.plots[n].u.posToVal(report.plots[n].u.over.clientWidth / 4, "x"), n);
  const time = await under();
  await page.keyboard.down("Control");
  await wheel(page, -100);
  await page.keyboard.up("Control");
  const near = await range(page, n), width = before[1] - before[0];
  assert.ok(near[1] - near[0] < 0.9 * width);
  // What is under the pointer stays there.
  assert.ok(Math.abs(await under() - time) < 0.01 * width, `${await under()}, ${time}`);
  const here = await page.evaluate(() => scrollY);
  await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
  await wheel(page, -100);
  const nearer = await range(page, n);
  assert.ok(nearer[1] - nearer[0] < near[1] - near[0]);
  assert.equal(await page.evaluate(() => scrollY), here);
  await page.keyboard.down("Shift");
  await drag(page, box, [0.5, 0.5], [0.25, 0.5]);
  await page.keyboard.up("Shift");
  const moved = await range(page, n), by = 0.25 * (nearer[1] - nearer[0]);
  assert.ok(Math.abs(moved[0] - nearer[0] - by) < 0.2 * by && Math.abs(moved[1] - moved[0] - nearer[1] + nearer[0]) < 1e-6, `${moved}, ${nearer}`);
  // Out again until all is seen, and no farther.
  for (let i = 0; i < 40; i++) await page.mouse.wheel(0, 200);
  await settled(page);
  assert.deepEqual((await range(page, n)).slice(0, 2), before.slice(0, 2));
  // The cursor by the keys.
  await page.keyboard.press("Shift+ArrowRight");
  assert.match(await page.evaluate(n => report.plots[n].where.textContent, n), /\d/);
  assert.deepEqual(troubles, []);
  await close();
});

test("two fingers zoom", async () => {
  const { page, troubles, close } = await open(browser, "navigate", { ...from, viewport: { width: 400, height: 800 }, isMobile: true, hasTouch: true });
  const n = await find(page, "velocity east"), all = await range(page, n), box = await areaOf(page, n);
  const touch = await page.context().newCDPSession(page);
  const fingers = (type, ...xs) => touch.send("Input.dispatchTouchEvent", { type, touchPoints: xs.map((x, id) => ({ id, x: box.x + x * box.width, y: box.y + box.height / 2 })) });
  await fingers("touchStart", 0.4);
  await fingers("touchStart", 0.4, 0.6);
  for (const d of [0.12, 0.16, 0.2]) await fingers("touchMove", 0.5 - d, 0.5 + d);
  await fingers("touchEnd");
  await settled(page);
  const part = await range(page, n), share = (part[1] - part[0]) / (all[1] - all[0]);
  assert.ok(share > 0.4 && share < 0.62, String(share));
  assert.deepEqual(troubles, []);
  await close();
});

test("a map has a scale bar, north, and the fixes with their standard deviations", async () => {
  const { page, close } = await open(browser, "navigate", from);
  const map = await find(page, "north [m]");
  const marks = () => page.evaluate(map => {
    const at = report.plots[map].frame(), { d, texts } = mapMarks(at), wide = Number(d.match(/h([\d.]+)/)[1]);
    const [, length, unit] = texts[0][2].match(/^([\d.]+) (km|m|cm)$/);
    return { metres: length * { km: 1e3, m: 1, cm: 0.01 }[unit], measured: wide / Math.abs(at.x(1) - at.x(0)), share: wide / at.width, north: texts[1][2] };
  }, map);
  const check = ({ metres, measured, share, north }) => {
    assert.ok(Math.abs(measured / metres - 1) < 0.01, `${measured}, ${metres}`);
    assert.ok(share > 0.05 && share <= 0.2 && north === "N");
    assert.ok([1, 2, 5].includes(metres / 10 ** Math.floor(Math.log10(metres) + 1e-9)), String(metres));
  };
  check(await marks());
  const rings = () => page.evaluate(map => {
    const { panel } = report.plots[map], fixes = panel.series.find(s => s.name === "fixes");
    return { paths: shapes(panel, fixes, report.plots[map].frame()).length, count: fixes.x.length, sigma: fixes.sigma.map(column => column[0]) };
  }, map);
  const far = await rings();
  assert.equal(far.paths, 1);
  assert.ok(far.count > 50 && far.count <= 1000 && far.sigma.every(s => s > 1e-3 && s < 100), JSON.stringify(far));
  assert.ok(await page.evaluate(map => report.plots[map].panel.series.find(s => s.name === "rejected fixes").x.length, map) > 2);
  await page.evaluate(map => {
    const { x: [x], y: [[y]], sigma: [[sigma]] } = report.plots[map].panel.series.find(s => s.name === "fixes"), around = v => [v - 20 * sigma, v + 20 * sigma];
    report.plots[map].setZoom({ x: around(x), y: around(y) });
  }, map);
  assert.equal((await rings()).paths, 2);
  check(await marks());
  // The first view has them too.
  assert.match(await page.evaluate(() => document.querySelector(".paper .map").textContent), /^[\d.]+ k?mN$/);
  await close();
});

test("bias models have one colour and one pattern in all figures, and ways on the map", async () => {
  const { page, close } = await open(browser, "outages", from);
  const MODELS = ["white", "paper", "gauss-markov", "random-walk", "ar", "arma"];
  const lines = await page.evaluate(() => report.plots.map(({ panel }) => ({ map: panel.scale, lines: panel.series.filter(s => s.style === "line").map(({ name, colour, dash }) => ({ name, look: `${colour} ${dash || 0}` })) })));
  const looks = new Map();
  for (const { lines: own } of lines) for (const { name, look } of own) {
    const model = name.split(" = ").at(-1);
    if (!MODELS.includes(model)) continue;
    assert.equal(looks.get(model) || look, look, model);
    looks.set(model, look);
  }
  assert.ok(looks.size >= 3, String([...looks]));
  for (const part of [0, 1]) assert.equal(new Set([...looks.values()].map(look => look.split(" ")[part])).size, looks.size, String([...looks]));
  // Every model has a line of its own or with others, also on the map.
  const named = ({ lines }) => lines.flatMap(({ name }) => name.split(" = ")).filter(name => MODELS.includes(name)).sort();
  // White noise alone diverges here, and then has no curve of its drift.
  assert.ok(named(lines[0]).length >= 5);
  assert.deepEqual(named(lines.find(({ map }) => map)), [...MODELS].sort());
  await close();
});

test("the verdict is first, the contents have numbers", async () => {
  for (const [name, note] of [["navigate", /NIS \/ dof [\d.]+/], ["outages", /least [\d.]+ m/], ["identify", /N [\d.]+ °\/√h/]]) {
    const { page, close } = await open(browser, name, { ...from, javaScriptEnabled: false });
    assert.match(await page.locator("section").first().locator("h2 + *").first().getAttribute("class"), /^verdict( care| unusable)?$/, name);
    assert.match(await page.locator(".verdict").first().textContent(), /^(Usable|Not usable)/, name);
    assert.match(await page.locator("nav").textContent(), note, name);
    const unnamed = await page.evaluate(() => Array.from(document.querySelectorAll(".paper")).filter(svg => svg.getAttribute("role") !== "img" || !/^(Plot|Map)\. .* over /.test(svg.getAttribute("aria-label"))).map(svg => svg.getAttribute("aria-label"))).catch(() => []);
    assert.deepEqual(unnamed.filter(label => !/largest horizontal/.test(label)), [], name);
    await close();
  }
});

test("the axes of a recording are folded, a link unfolds one, paper shows all", async () => {
  const { page, troubles, close } = await open(browser, "identify", from);
  assert.equal(await page.locator("details").count(), 6);
  assert.equal(await page.locator("details[open]").count(), 0);
  assert.ok(await page.evaluate(() => document.documentElement.scrollHeight) < 4000);
  await page.locator("nav a", { hasText: "Gyro y" }).click();
  await settled(page);
  assert.equal(await page.locator("details[open]").count(), 1);
  const plot = page.locator("details[open] canvas").first();
  await plot.scrollIntoViewIfNeeded();
  const { width, right } = await page.evaluate(() => { const c = document.querySelector("details[open] canvas").getBoundingClientRect(), p = document.querySelector("details[open] .panel").getBoundingClientRect(); return { width: c.width, right: c.right - p.right }; });
  assert.ok(width > 300 && right <= 1, `${width}, ${right}`);
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  assert.equal(await page.locator("details[open]").count(), 6);
  await page.evaluate(() => dispatchEvent(new Event("afterprint")));
  assert.equal(await page.locator("details[open]").count(), 1);
  assert.deepEqual(troubles, []);
  await close();
});

test("on a phone the names below boxes are whole, and tables show that they go on", async () => {
  for (const name of ["outages", "demo"]) {
    const { page, close } = await open(browser, name, { ...from, viewport: { width: 390, height: 800 }, isMobile: true, hasTouch: true });
    const cut = await page.evaluate(() => report.plots.filter(p => p.panel.x.names.length).flatMap(({ u, panel }) => {
      const { labels, upright } = nameLabels(panel.x.names, u.bbox.width / devicePixelRatio / (u.scales.x.max - u.scales.x.min) - 8);
      // Upright or not, each has its own line's room below the axis.
      return labels.filter((label, i) => label.replace(/\n/g, "") !== panel.x.names[i].replace(/ /g, m => label.includes("\n") ? "" : m)).concat(upright && u.height - u.bbox.height / devicePixelRatio < 60 ? ["low"] : []);
    }));
    assert.deepEqual(cut, [], name);
    const shadow = await page.evaluate(() => Array.from(document.querySelectorAll(".scroll")).filter(box => box.scrollWidth > box.clientWidth).map(box => getComputedStyle(box).backgroundAttachment));
    assert.ok(shadow.length > 0 && shadow.every(text => /local, local, scroll, scroll/.test(text)), String(shadow));
    await close();
  }
});
