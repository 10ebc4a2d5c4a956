// What tests do with a page and see on it.
import { readFile } from "node:fs/promises";

// The plot of a panel with a title, as an expression in the page.
export const plotOf = title => `report.plots.find(plot => plot.panel.title === ${JSON.stringify(title)})`;

// A colour of the style as pixels have it.
const RGB = `(hex => "rgb(" + [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16)).join(", ") + ")")`;

// Pixels inside the plot area of every plot: of how many colours, and how many of a given one.
export const coloured = page => page.evaluate(`report.plots.map(plot => {
  const { ctx, bbox } = plot.u;
  const { data } = ctx.getImageData(bbox.left, bbox.top, bbox.width, bbox.height);
  const grounds = ["grid", "shade"].map(name => ${RGB}(plot.palette[name]));
  let count = 0;
  for (let i = 0; i < data.length; i += 4) {
    const opaque = data[i + 3] === 255, colour = "rgb(" + [data[i], data[i + 1], data[i + 2]].join(", ") + ")";
    if (data[i + 3] > 0 && !(opaque && grounds.includes(colour))) count++;
  }
  return { title: plot.panel.title, count };
})`);

export const hash = (page, title) => page.evaluate(`(() => {
  const { ctx } = ${plotOf(title)}.u;
  const { data } = ctx.getImageData(0, 0, ctx.canvas.width, ctx.canvas.height);
  let h = 0;
  for (let i = 0; i < data.length; i++) h = (h * 31 + data[i]) | 0;
  return h;
})()`);

// Pixels of a plot in exactly the colour of a series.
export const ofColour = (page, title, name) => page.evaluate(`(plot => {
  const { ctx, bbox } = plot.u, colour = ${RGB}(plot.palette[plot.panel.series.find(s => s.name === ${JSON.stringify(name)}).colour]);
  const { data } = ctx.getImageData(bbox.left, bbox.top, bbox.width, bbox.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (colour === "rgb(" + data[i] + ", " + data[i + 1] + ", " + data[i + 2] + ")") count++;
  return count;
})(${plotOf(title)})`);

export const scales = (page, title) => page.evaluate(`(({ x, y }) => [x.min, x.max, y.min, y.max])(${plotOf(title)}.u.scales)`);

export const settled = page => page.evaluate(() => new Promise(done => requestAnimationFrame(() => setTimeout(done, 30))));

// Where the plot area of a panel is on the screen.
export async function area(page, title) {
  await page.evaluate(`${plotOf(title)}.u.over.scrollIntoView({ block: "center" })`);
  await settled(page);
  return page.evaluate(`(r => ({ x: r.x, y: r.y, width: r.width, height: r.height }))(${plotOf(title)}.u.over.getBoundingClientRect())`);
}

export async function drag(page, box, from, to) {
  const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
  await page.mouse.move(...at(from));
  await page.mouse.down();
  await page.mouse.move(...at([(from[0] + to[0]) / 2, (from[1] + to[1]) / 2]));
  await page.mouse.move(...at(to), { steps: 4 });
  await page.mouse.up();
  await settled(page);
}

export async function download(page, click) {
  const [file] = await Promise.all([page.waitForEvent("download"), click()]);
  return { name: file.suggestedFilename(), text: await readFile(await file.path(), "utf8") };
}

export const tool = (page, id, name) => page.locator(`#${id} .tools button`, { hasText: new RegExp(`^${name}$`) });

export function parseCsv(text) {
  return text.trimEnd().split("\r\n").map(line => {
    const cells = [];
    for (const [, quoted, plain] of ("," + line).matchAll(/,(?:"((?:[^"]|"")*)"|([^,]*))/g)) cells.push(quoted === undefined ? plain : quoted.replace(/""/g, '"'));
    return cells;
  });
}
