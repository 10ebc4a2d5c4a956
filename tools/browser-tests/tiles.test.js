// The background of maps: asked of OpenStreetMap on request alone, in its place, and nowhere else.
import test, { before, after } from "node:test";
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { crc32, deflateSync } from "node:zlib";
import { launch, open, real, samples } from "./browser.js";
import { download, settled, tool } from "./page.js";

const TILES = "tile.openstreetmap.org", SITE = "https://report.example/";
let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

// A tile: a checkerboard of 8 x 8 fields, the one in the upper left corner red.
const tile = (() => {
  const size = 256, rows = [];
  for (let y = 0; y < size; y++) {
    rows.push(0);
    for (let x = 0; x < size; x++) rows.push(...(x < 32 && y < 32 ? [220, 60, 60] : (x >> 5) + (y >> 5) & 1 ? [150, 190, 150] : [240, 235, 220]));
  }
  const word = value => { const bytes = Buffer.alloc(4); bytes.writeUInt32BE(value >>> 0); return bytes; };
  const chunk = (type, data) => { const body = Buffer.concat([Buffer.from(type), data]); return Buffer.concat([word(data.length), body, word(crc32(body))]); };
  return Buffer.concat([
    Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", Buffer.concat([word(size), word(size), Buffer.from([8, 2, 0, 0, 0])])),
    chunk("IDAT", deflateSync(Buffer.from(rows))), chunk("IEND", Buffer.alloc(0)),
  ]);
})();

// A report as served by a web server, and what it asks others for.
async function served(name, { folder = real, html, answer = route => route.fulfill({ contentType: "image/png", body: tile }), ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  const asked = [], troubles = [], page = await context.newPage();
  await context.route("**/*", async route => {
    const url = route.request().url();
    if (url.startsWith(SITE)) return route.fulfill({ contentType: "text/html; charset=utf-8", body: html || await readFile(path.join(folder, name + ".html")) });
    asked.push({ url, referer: (await route.request().allHeaders()).referer });
    return new URL(url).host === TILES ? answer(route) : route.abort();
  });
  page.on("console", message => { if (["error", "warning"].includes(message.type()) && !/willReadFrequently/.test(message.text())) troubles.push(message.text()); });
  page.on("pageerror", error => troubles.push(String(error)));
  await page.goto(SITE + name + ".html");
  return { page, asked, troubles, box: page.getByRole("checkbox", { name: /^Map background \(asks tile\.openstreetmap\.org/ }), close: () => context.close() };
}

// Until the view has stood still and its tiles are there.
async function still(page) {
  await page.waitForTimeout(400);
  await page.waitForFunction(() => Array.from(document.querySelectorAll(".tiles img")).every(image => image.complete));
  await settled(page);
}

// From a place on the ellipsoid to east and north of another, by the matrices of the textbook.
function eastNorth([lat, lon], [lat0, lon0]) {
  const a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f);
  const ecef = (lat, lon) => { const n = a / Math.sqrt(1 - e2 * Math.sin(lat) ** 2); return [n * Math.cos(lat) * Math.cos(lon), n * Math.cos(lat) * Math.sin(lon), n * (1 - e2) * Math.sin(lat)]; };
  const [p, q] = [ecef(lat, lon), ecef(lat0, lon0)], d = p.map((v, i) => v - q[i]), dot = row => row.reduce((sum, v, i) => sum + v * d[i], 0);
  return [dot([-Math.sin(lon0), Math.cos(lon0), 0]), dot([-Math.sin(lat0) * Math.cos(lon0), -Math.sin(lat0) * Math.sin(lon0), Math.cos(lat0)])];
}
const corner = (zoom, x, y) => [Math.atan(Math.sinh(Math.PI * (1 - 2 * y / 2 ** zoom))), (x / 2 ** zoom * 360 - 180) * Math.PI / 180];
const zxy = url => url.match(/^https:\/\/tile\.openstreetmap\.org\/(\d+)\/(\d+)\/(\d+)\.png$/).slice(1).map(Number);

// Where the corners of the tiles are on the screen, and where those places are on the map.
async function apart(page) {
  const { origin, images } = await page.evaluate(() => {
    const plot = report.plots.find(plot => plot.background && plot.background.box.checked), at = plot.frame(), over = plot.u.over.getBoundingClientRect();
    const line = v => [at.x(0) + over.x + v[0] * (at.x(1) - at.x(0)), at.y(0) + over.y + v[1] * (at.y(1) - at.y(0))];
    return {
      origin: { ...plot.panel.origin, zero: line([0, 0]), one: line([1, 1]) },
      images: Array.from(document.querySelectorAll(".tiles img"), image => {
        const matrix = new DOMMatrix(getComputedStyle(image).transform), layer = image.parentNode.getBoundingClientRect(), { x, y, right, bottom } = image.getBoundingClientRect();
        const corners = [[0, 0], [256, 0], [256, 256], [0, 256]].map(([x, y]) => { const p = matrix.transformPoint(new DOMPoint(x, y)); return [layer.x + p.x / p.w, layer.y + p.y / p.w]; });
        return { src: image.src, corners, box: [x, y, right, bottom] };
      }),
    };
  });
  const start = [origin.lat_deg, origin.lon_deg].map(v => v * Math.PI / 180);
  let worst = 0;
  for (const { src, corners, box } of images) {
    const [zoom, x, y] = zxy(src);
    const expected = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([right, down]) => {
      const place = eastNorth(corner(zoom, x + right, y + down), start);
      return place.map((v, i) => origin.zero[i] + v * (origin.one[i] - origin.zero[i]));
    });
    expected.forEach((place, i) => { worst = Math.max(worst, Math.hypot(place[0] - corners[i][0], place[1] - corners[i][1])); });
    const [xs, ys] = [0, 1].map(i => expected.map(place => place[i]));
    [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)].forEach((v, i) => { worst = Math.max(worst, Math.abs(v - box[i])); });
  }
  return worst;
}

// The tiles that show, of one zoom, cover the plot.
async function covered(page) {
  const { over, boxes, zooms } = await page.evaluate(() => {
    const side = ({ x, y, right, bottom }) => [x, y, right, bottom], images = Array.from(document.querySelectorAll(".tiles img"));
    return { over: side(document.querySelector(".tiles").getBoundingClientRect()), boxes: images.map(image => side(image.getBoundingClientRect())), zooms: images.map(image => image.src.split("/")[3]) };
  });
  assert.equal(new Set(zooms).size, 1, String(zooms));
  const extreme = (i, pick) => pick(...boxes.map(box => box[i]));
  assert.ok(extreme(0, Math.min) <= over[0] + 1 && extreme(1, Math.min) <= over[1] + 1 && extreme(2, Math.max) >= over[2] - 1 && extreme(3, Math.max) >= over[3] - 1, JSON.stringify({ over, boxes }));
  return { zoom: Number(zooms[0]), count: boxes.length };
}

test("a map asks for its background on demand, for its place, and no longer when it is taken away", async () => {
  for (const name of ["navigate", "outages"]) {
    const { page, asked, troubles, box, close } = await served(name);
    await settled(page);
    await page.evaluate(() => report.plots.find(plot => plot.background).change(0.8));
    await still(page);
    await page.evaluate(() => report.plots.find(plot => plot.background).setZoom(null));
    assert.deepEqual(asked, [], name);
    assert.equal(await box.count(), 1, name);
    assert.ok(!await box.isChecked());
    assert.equal(await page.locator(".credit").count(), 0);
    await box.check();
    await still(page);
    // The drive of the tests starts here.
    const fix = (await readFile(path.join(real, "hostile-drive/truth.csv"), "utf8").catch(() => "")).split("\n")[1];
    const { lat_deg, lon_deg } = await page.evaluate(() => report.plots.find(plot => plot.background).panel.origin);
    if (fix) assert.ok(Math.hypot(Number(fix.split(",")[1]) - lat_deg, Number(fix.split(",")[2]) - lon_deg) < 1e-3, `${fix}: ${lat_deg}, ${lon_deg}`);
    assert.ok(asked.every(({ url, referer }) => zxy(url) && referer === SITE), JSON.stringify(asked));
    const first = await covered(page);
    assert.ok(first.count <= 60 && first.count === asked.length && first.zoom >= 10 && first.zoom <= 19, JSON.stringify(first));
    const n = 2 ** first.zoom, lat = lat_deg * Math.PI / 180;
    const own = [first.zoom, Math.floor((lon_deg / 360 + 0.5) * n), Math.floor((1 - Math.log(Math.tan(lat) + 1 / Math.cos(lat)) / Math.PI) / 2 * n)];
    assert.ok(asked.some(({ url }) => String(zxy(url)) === String(own)), `${own} of ${asked.map(({ url }) => url)}`);
    assert.ok(await apart(page) < 1, `${await apart(page)} pixels`);
    assert.equal(await page.locator(".credit:visible").textContent(), "© OpenStreetMap contributors");
    // Nearer, moved, and of another size.
    const change = async (...how) => { await page.evaluate(how => report.plots.find(plot => plot.background).change(...how), how); await still(page); };
    await change(0.2, [0.3, 0.6]);
    const near = await covered(page);
    assert.ok(near.zoom > first.zoom && near.count <= 60, JSON.stringify([first, near]));
    assert.ok(await apart(page) < 1);
    await change(1, undefined, [0.6, -0.4]);
    await page.setViewportSize({ width: 800, height: 900 });
    await still(page);
    await covered(page);
    assert.ok(await apart(page) < 1);
    // As near as a map goes.
    await change(1e-3);
    assert.equal((await covered(page)).zoom, 19);
    await box.uncheck();
    assert.equal(await page.locator(".tiles, .credit, .tiles img").count(), 0);
    const before = asked.length;
    await change(50);
    assert.equal(asked.length, before);
    // Nobody remembers it.
    await box.check();
    await page.reload();
    assert.ok(!await box.isChecked());
    assert.deepEqual(troubles, []);
    await close();
  }
});

test("tiles of a wide map are where they belong too", async () => {
  const { page, box, close } = await served("navigate");
  await box.check();
  for (const wide of [3e4, 2e5, 9e5]) {
    await page.evaluate(wide => report.plots.find(plot => plot.background).setZoom({ x: [-wide, wide / 4], y: [-wide / 5, wide / 5] }), wide);
    await still(page);
    const { count } = await covered(page);
    assert.ok(count <= 60 && await apart(page) < 1, `${wide}: ${count}, ${await apart(page)}`);
  }
  await page.evaluate(() => report.plots.find(plot => plot.background).setZoom({ x: [-2e6, 2e6], y: [-1e6, 1e6] }));
  await still(page);
  assert.equal(await page.locator(".tiles img").count(), 0);
  await close();
});

test("on a phone, dark, by the keyboard", async () => {
  const { page, asked, troubles, box, close } = await served("navigate", { viewport: { width: 390, height: 800 }, isMobile: true, hasTouch: true, deviceScaleFactor: 2, colorScheme: "dark" });
  await box.focus();
  await page.keyboard.press("Space");
  await still(page);
  assert.ok(asked.length > 0 && asked.length <= 60);
  assert.ok(await apart(page) < 1);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  const { credit, map } = await page.evaluate(() => {
    const side = ({ x, y, right, bottom }) => [x, y, right, bottom];
    return { credit: side(document.querySelector(".credit").getBoundingClientRect()), map: side(document.querySelector(".tiles").getBoundingClientRect()) };
  });
  assert.ok(credit[0] >= map[0] && credit[1] >= map[1] && Math.abs(credit[2] - map[2]) < 1 && Math.abs(credit[3] - map[3]) < 1, JSON.stringify({ credit, map }));
  assert.match(await page.evaluate(() => getComputedStyle(document.querySelector(".tiles")).filter), /invert/);
  assert.deepEqual(troubles, []);
  await close();
});

test("files and paper have no tiles", async () => {
  const { page, asked, troubles, box, close } = await served("navigate");
  await box.check();
  await still(page);
  const before = asked.length, id = await page.evaluate(() => report.plots.find(plot => plot.background).holder.closest("figure").id);
  const svg = await download(page, () => tool(page, id, "SVG").click());
  assert.ok(!/<image|openstreetmap/i.test(svg.text));
  const [png] = await Promise.all([page.waitForEvent("download"), tool(page, id, "PNG").click()]);
  assert.ok((await readFile(await png.path())).length > 10e3);
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  assert.equal(await page.locator(".tiles:visible, .credit:visible, input:visible").count(), 0);
  await still(page);
  assert.equal(asked.length, before);
  assert.deepEqual(troubles, []);
  await close();
});

test("tiles that do not come are reported", async () => {
  const { page, box, close } = await served("navigate", { answer: route => route.abort() });
  await box.check();
  await page.getByRole("status").filter({ hasText: /^tile\.openstreetmap\.org sent 0 of \d+ pictures/ }).waitFor();
  assert.equal(await page.locator(".tiles img").count(), 0);
  await box.uncheck();
  assert.equal(await page.getByRole("status").filter({ hasText: /sent/ }).count(), 0);
  await close();
});

test("opened as a file a report asks for nothing and says why", async () => {
  const { page, troubles, close } = await open(browser, "navigate", { folder: real });
  const box = page.getByRole("checkbox", { name: /^Map background/ });
  await box.click();
  await page.getByRole("status").filter({ hasText: /refuses pages that are opened as files.*http\.server/ }).waitFor();
  assert.ok(!await box.isChecked());
  assert.equal(await page.locator(".tiles, .credit").count(), 0);
  assert.deepEqual(troubles, []);
  await close();
});

test("without a place on Earth there is no background, and the policy is as strict as before", async () => {
  for (const [name, folder] of [["identify", real], ["demo", real], ["kinds", samples], ["hostile", samples]]) {
    const { page, box, close } = await served(name, { folder });
    assert.equal(await box.count(), 0, name);
    assert.match(await page.content(), /img-src data: blob:;/, name);
    await close();
  }
});

test("in a page that sends nothing, a report has no background", async () => {
  const report = (await readFile(path.join(real, "navigate.html"), "utf8")).replaceAll("&", "&amp;").replaceAll('"', "&quot;");
  const { page, asked, close } = await served("page", { html: `<!doctype html><iframe sandbox="allow-scripts allow-downloads" srcdoc="${report}"></iframe>` });
  const frame = page.frameLocator("iframe");
  await frame.locator("canvas").first().waitFor();
  assert.equal(await frame.locator("input").count(), 0);
  assert.deepEqual(asked, []);
  await close();
});
