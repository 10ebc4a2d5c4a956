// Sample reports in a real browser. They are written by `cargo run -p undrift-lab --bin report_sample`.
import test, { before, after } from "node:test";
import assert from "node:assert/strict";
import { readFile, stat } from "node:fs/promises";
import path from "node:path";
import { launch, open, samples } from "./browser.js";
import { area, coloured, download, drag, hash, ofColour, parseCsv, plotOf, scales, settled, tool } from "./page.js";

const HOSTILE = `</script><img src=x onerror=alert(1)><!--<script>"'&`;
let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

test("every plot is drawn, without errors or requests", async () => {
  for (const [name, plots] of [["kinds", 9], ["hostile", 11], ["large", 12]]) {
    const { page, troubles, close } = await open(browser, name);
    const counts = await coloured(page);
    assert.equal(counts.length, plots, name);
    const bare = ["nothing but NaN", "still", "", "constant", "extreme", "extreme decades", "extreme map"];
    for (const { title, count } of counts) {
      if (name === "hostile" && bare.includes(title)) continue;
      assert.ok(count > 20, `${name}: ${title} has ${count} pixels`);
    }
    assert.equal(await page.locator(".panel canvas").count(), plots);
    assert.deepEqual(troubles, []);
    await close();
  }
});

test("hostile text is text", async () => {
  const { page, troubles, close } = await open(browser, "hostile");
  assert.equal(await page.locator("h1").textContent(), HOSTILE);
  assert.equal(await page.locator("h2").first().textContent(), HOSTILE);
  assert.equal(await page.locator("td").first().textContent(), HOSTILE);
  assert.equal(await page.locator(".legend button > span").first().textContent(), HOSTILE);
  assert.equal(await page.locator("h3").first().textContent(), HOSTILE);
  assert.equal(await page.locator("img").count(), 0);
  assert.equal(await page.title(), HOSTILE);
  // The policy of the page stops what would get past all that.
  await page.evaluate(() => { document.body.insertAdjacentHTML("beforeend", "<img src=x onerror='window.ran = 1'>"); });
  await settled(page);
  assert.equal(await page.evaluate(() => window.ran), undefined);
  assert.ok(troubles.every(t => /Content Security Policy/.test(t)) && troubles.length > 0, troubles.join("\n"));
  await close();
});

test("files and copies of hostile text are sound", async () => {
  const { page, close } = await open(browser, "hostile");
  const svg = await download(page, () => tool(page, "figure-1", "SVG").click());
  assert.match(svg.name, /^[\p{L}\p{N}_-]+\.svg$/u);
  const root = await page.evaluate(text => {
    const xml = new DOMParser().parseFromString(text, "image/svg+xml");
    return { error: xml.querySelector("parsererror")?.textContent, images: xml.querySelectorAll("image, script, img").length, texts: Array.from(xml.querySelectorAll("text"), t => t.textContent) };
  }, svg.text);
  assert.equal(root.error, undefined);
  assert.equal(root.images, 0);
  assert.ok(root.texts.includes(HOSTILE));
  const csv = await download(page, () => tool(page, "table-1", "CSV").click());
  assert.equal(parseCsv(csv.text)[1][0], HOSTILE);
  await close();
});

test("a series is hidden and shown by mouse and by keyboard", async () => {
  const { page, troubles, close } = await open(browser, "kinds");
  const button = page.locator(".legend button", { hasText: "Random walk" });
  assert.ok(await ofColour(page, "Drift", "Random walk") > 50);
  const first = await hash(page, "Drift");
  await button.click();
  await settled(page);
  assert.equal(await button.getAttribute("aria-pressed"), "false");
  assert.equal(await ofColour(page, "Drift", "Random walk"), 0);
  assert.ok(await ofColour(page, "Drift", "AR(3)") > 50);
  await button.focus();
  await page.keyboard.press("Enter");
  await settled(page);
  assert.equal(await button.getAttribute("aria-pressed"), "true");
  await page.mouse.move(0, 0);
  assert.equal(await hash(page, "Drift"), first);
  // The axis follows what is shown.
  const [, , , top] = await scales(page, "RMS");
  await page.locator(".legend button", { hasText: "120 s" }).click();
  assert.ok((await scales(page, "RMS"))[3] < 0.6 * top);
  assert.deepEqual(troubles, []);
  await close();
});

test("dragging zooms, panels of one time follow, a double click resets", async () => {
  const { page, troubles, close } = await open(browser, "kinds");
  const before = await scales(page, "Velocity");
  const box = await area(page, "Velocity");
  await drag(page, box, [0.25, 0.5], [0.5, 0.6]);
  const zoomed = await scales(page, "Velocity");
  const width = before[1] - before[0];
  // Half a pixel at either end.
  const pixel = width / box.width;
  assert.ok(Math.abs(zoomed[0] - (before[0] + 0.25 * width)) <= pixel, String(zoomed));
  assert.ok(Math.abs(zoomed[1] - (before[0] + 0.5 * width)) <= pixel, String(zoomed));
  assert.deepEqual((await scales(page, "Gyro bias")).slice(0, 2), zoomed.slice(0, 2));
  assert.equal(await page.locator(".reset:visible").count(), 2);
  await page.mouse.dblclick(box.x + box.width / 2, box.y + box.height / 2);
  await settled(page);
  assert.deepEqual(await scales(page, "Velocity"), before);
  assert.equal(await page.locator(".reset:visible").count(), 0);
  // The button does the same.
  await drag(page, box, [0.6, 0.5], [0.4, 0.5]);
  assert.notDeepEqual(await scales(page, "Velocity"), before);
  await page.locator(".reset:visible").first().click();
  assert.deepEqual(await scales(page, "Velocity"), before);
  assert.deepEqual(troubles, []);
  await close();
});

test("a map stays to scale, zoomed and resized", async () => {
  const { page, close } = await open(browser, "kinds");
  const shape = async () => {
    const [x0, x1, y0, y1] = await scales(page, "Track");
    const { width, height } = await page.evaluate(`${plotOf("Track")}.inner()`);
    return (x1 - x0) / width / ((y1 - y0) / height);
  };
  const near = (value, what) => assert.ok(Math.abs(value - 1) < 0.01, `${what}: ${value}`);
  near(await shape(), "first");
  const before = await scales(page, "Track");
  await drag(page, await area(page, "Track"), [0.1, 0.1], [0.3, 0.6]);
  const zoomed = await scales(page, "Track");
  assert.ok(zoomed[1] - zoomed[0] < 0.7 * (before[1] - before[0]));
  near(await shape(), "zoomed");
  await page.setViewportSize({ width: 700, height: 900 });
  await settled(page);
  near(await shape(), "resized");
  await close();
});

test("the cursor reads values, in panels of one time at once", async () => {
  const { page, close } = await open(browser, "kinds");
  const box = await area(page, "Gyro bias");
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await settled(page);
  const number = text => Number(text.replace("−", "-"));
  const panel = title => page.locator(".panel", { has: page.locator("h3", { hasText: new RegExp(`^${title}$`) }) });
  const expected = await page.evaluate(`(() => {
    const plot = ${plotOf("Gyro bias")}, time = plot.u.posToVal(plot.u.cursor.left, "x");
    const series = plot.panel.series[1], i = series.x.findIndex(x => x >= time - 0.25);
    return { bias: series.y[0][i], time };
  })()`);
  assert.ok(Math.abs(number(await panel("Gyro bias").locator("output").nth(1).textContent()) - expected.bias) < 1e-3 * Math.abs(expected.bias));
  const [low, high] = (await panel("Gyro bias").locator("output").first().textContent()).split(" … ").map(number);
  assert.ok(low < expected.bias && expected.bias < high);
  assert.ok(Math.abs(number((await panel("Velocity").locator(".x").textContent()).replace("time [s] ", "")) - expected.time) < 1);
  assert.notEqual(await panel("Velocity").locator("output").first().textContent(), "");
  // On a map the nearest point, east and north.
  const map = await area(page, "Track");
  const at = await page.evaluate(`(({ u, panel }) => { const s = panel.series[0]; return [u.valToPos(s.x[500], "x"), u.valToPos(s.y[0][500], "y"), s.x[500], s.y[0][500]]; })(${plotOf("Track")})`);
  await page.mouse.move(map.x + at[0], map.y + at[1]);
  await settled(page);
  const [east, north] = (await panel("Track").locator("output").first().textContent()).split(", ").map(number);
  assert.ok(Math.hypot(east - at[2], north - at[3]) < 10, `${east}, ${north} for ${at}`);
  await page.mouse.move(2, 2);
  await settled(page);
  assert.equal(await panel("Track").locator("output").first().textContent(), "");
  await close();
});

test("light and dark", async () => {
  const ground = page => page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor);
  for (const colorScheme of ["light", "dark"]) {
    const { page, troubles, close } = await open(browser, "kinds", { colorScheme });
    const light = "rgb(255, 255, 255)";
    assert.equal(await ground(page) === light, colorScheme === "light");
    const drawn = await hash(page, "Drift");
    await page.locator("#theme").click();
    await settled(page);
    assert.equal(await ground(page) === light, colorScheme === "dark");
    assert.notEqual(await hash(page, "Drift"), drawn);
    assert.deepEqual(troubles, []);
    await close();
  }
});

test("on a phone the page does not scroll sideways, tables do", async () => {
  for (const name of ["kinds", "hostile"]) {
    const { page, troubles, close } = await open(browser, name, { viewport: { width: 400, height: 800 }, deviceScaleFactor: 2, isMobile: true, hasTouch: true });
    const { scroll, width } = await page.evaluate(() => ({ scroll: document.documentElement.scrollWidth, width: innerWidth }));
    assert.equal(width, 400);
    assert.ok(scroll <= 400, `${name}: ${scroll}`);
    if (name === "kinds") assert.ok(await page.evaluate(() => { const box = document.querySelector("#table-2 .scroll"); return box.scrollWidth > box.clientWidth; }));
    assert.deepEqual(troubles, []);
    await close();
  }
});

test("the CSV of a figure holds its numbers", async () => {
  const { page, close } = await open(browser, "kinds");
  const { name, text } = await download(page, () => tool(page, "figure-2", "CSV").click());
  assert.equal(name, "time.csv");
  const [head, ...rows] = parseCsv(text);
  assert.deepEqual(head, ["Velocity: time [s]", "Velocity: north", "Velocity: time [s]", "Velocity: east", "Gyro bias: time [s]", "Gyro bias: ±2σ, lower", "Gyro bias: ±2σ, upper", "Gyro bias: gyro z"]);
  assert.equal(rows.length, 100000);
  const columns = await page.evaluate(() => report.plots.filter(p => ["Velocity", "Gyro bias"].includes(p.panel.title))
    .flatMap(p => p.panel.series.flatMap((s, i, all) => [...(i && all[i - 1].x === s.x ? [] : [s.x]), ...s.y])));
  columns.forEach((column, c) => rows.forEach((row, r) => {
    const cell = row[c] === "" ? null : Number(row[c]);
    if (cell !== (column[r] ?? null)) assert.fail(`${head[c]}, row ${r}: ${cell}, not ${column[r]}`);
  }));
  // In closed form, to the seven digits that are kept.
  rows.slice(0, 2000).forEach((row, i) => assert.ok(Math.abs(Number(row[3]) - 5 * Math.cos(i * 0.5 / 70)) < 1e-6));
  assert.equal(rows[61300][1], "");
  await close();
});

test("the SVG of a figure is what is seen", async () => {
  const { page, close } = await open(browser, "kinds", { colorScheme: "dark" });
  const parse = text => page.evaluate(text => {
    const xml = new DOMParser().parseFromString(text, "image/svg+xml");
    return { error: xml.querySelector("parsererror")?.textContent, curves: xml.querySelectorAll("[clip-path] path").length, texts: Array.from(xml.querySelectorAll("text"), t => t.textContent), ground: xml.querySelector("rect").getAttribute("fill") };
  }, text);
  const all = await parse((await download(page, () => tool(page, "figure-1", "SVG").click())).text);
  assert.equal(all.error, undefined);
  assert.equal(all.curves, 7);
  assert.equal(all.ground, "#ffffff");
  for (const text of ["Drift", "AR(3), 10–90 %", "horizontal error [m]", "60"]) assert.ok(all.texts.includes(text), text);
  await page.locator(".legend button", { hasText: "Random walk" }).click();
  const fewer = await parse((await download(page, () => tool(page, "figure-1", "SVG").click())).text);
  assert.equal(fewer.curves, 6);
  assert.ok(!fewer.texts.includes("Random walk"));
  // Zoomed: other numbers below the axis, the same names.
  await drag(page, await area(page, "Drift"), [0.1, 0.5], [0.2, 0.6]);
  const part = await parse((await download(page, () => tool(page, "figure-1", "SVG").click())).text);
  assert.equal(part.error, undefined);
  assert.equal(part.curves, 6);
  assert.ok(!part.texts.includes("60") && part.texts.includes("horizontal error [m]"));
  await close();
});

test("the PNG of a figure has its colours, in twice as many pixels", async () => {
  const { page, troubles, close } = await open(browser, "kinds", { colorScheme: "dark" });
  const [file] = await Promise.all([page.waitForEvent("download"), tool(page, "figure-1", "PNG").click()]);
  assert.match(file.suggestedFilename(), /\.png$/);
  const bytes = (await readFile(await file.path())).toString("base64");
  const { size, paper, colours } = await page.evaluate(async bytes => {
    const image = new Image();
    image.src = "data:image/png;base64," + bytes;
    await image.decode();
    const canvas = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height }), ctx = canvas.getContext("2d");
    ctx.drawImage(image, 0, 0);
    const { data } = ctx.getImageData(0, 0, image.width, image.height), counts = {};
    for (let i = 0; i < data.length; i += 4) { const colour = data.slice(i, i + 3).join(); counts[colour] = (counts[colour] || 0) + 1; }
    return { size: image.width, paper: counts["255,255,255"] / (image.width * image.height), colours: ["0,114,178", "213,94,0"].map(colour => counts[colour] || 0) };
  }, bytes);
  assert.ok(size >= 1680 && paper > 0.5, `${size}, ${paper}`);
  assert.ok(colours.every(count => count > 100), String(colours));
  assert.deepEqual(troubles, []);
  await close();
});

test("tables are copied and saved", async () => {
  const { page, close } = await open(browser, "kinds");
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await tool(page, "table-1", "Copy").click();
  await page.locator("#status", { hasText: "Copied" }).waitFor();
  const lines = (await page.evaluate(() => navigator.clipboard.readText())).split("\n");
  assert.equal(lines[0], "Model\tRMS [m]\tWorst [m]");
  assert.equal(lines[4], "AR(3)\t12.07\t31.66");
  // Without the clipboard, by way of a text field.
  await page.evaluate(() => { navigator.clipboard.writeText = () => Promise.reject(new Error("denied")); });
  await tool(page, "table-2", "Copy").click();
  await page.waitForFunction(() => document.querySelector("#status").textContent === "Copied");
  assert.match(await page.evaluate(() => navigator.clipboard.readText()), /^Axis\tN \[deg/);
  const { name, text } = await download(page, () => tool(page, "table-1", "CSV").click());
  assert.equal(name, "drift.csv");
  assert.deepEqual(parseCsv(text)[5], ["AR(6), not converged", "–", "–"]);
  await close();
});

test("on paper: light, every panel as lines, no buttons", async () => {
  const { page, close } = await open(browser, "kinds", { colorScheme: "dark" });
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  assert.equal(await page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor), "rgb(255, 255, 255)");
  assert.equal(await page.locator(".paper:visible").count(), 9);
  assert.equal(await page.locator("button:visible, canvas:visible, nav:visible").count(), 0);
  assert.equal(await page.locator("h2:visible").count(), 3);
  await page.evaluate(() => dispatchEvent(new Event("afterprint")));
  await page.emulateMedia({ media: "screen" });
  // The browser's own printing asks for the lines as well: pages full of pixels would be larger.
  const pdf = await page.pdf({ format: "A4" });
  assert.ok(pdf.length > 30e3 && pdf.length < 1e6, String(pdf.length));
  assert.equal(await page.locator(".paper:visible").count(), 0);
  await close();
});

test("without scripts text, tables and figures can be read", async () => {
  const { page, close } = await open(browser, "kinds", { javaScriptEnabled: false });
  assert.match(await page.locator("main p").first().textContent(), /^Among four models/);
  assert.equal(await page.locator("td:visible").count(), 15 + 24);
  assert.equal(await page.locator(".paper:visible").count(), 9);
  assert.ok(await page.locator(".paper .curves path").count() > 20);
  assert.ok((await page.locator(".paper text").allTextContents()).includes("horizontal error [m]"));
  assert.equal(await page.locator("button").count(), 0);
  await close();
});

test("a large report opens within two seconds", async () => {
  const { size } = await stat(path.join(samples, "large.html"));
  assert.ok(size < 5e6, String(size));
  const { page, close } = await open(browser, "large");
  const { ready, drawn } = await page.evaluate(() => ({ ready: report.ready, drawn: report.plots.every(plot => plot.drawn > 0) }));
  assert.ok(drawn);
  assert.ok(ready < 2000, `${ready} ms`);
  console.log(`# large.html: ${(size / 1e6).toFixed(1)} MB, drawn after ${Math.round(ready)} ms`);
  await close();
});
