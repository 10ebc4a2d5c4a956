// The page: figures from the data, files to save, themes, paper.
"use strict";

// The panel as an SVG group as it is seen, its legend above it; and its size.
function panelSvg(plot, palette, width = plot.u.width) {
  const { panel } = plot, { x, y } = plot.u.scales;
  const height = heightOf(panel, width);
  const yTicks = axisTicks(panel.y, "y", y.min, y.max, height - 60);
  const left = (panel.y.label ? 26 : 6) + 8 + Math.max(12, ...yTicks.labels.map(l => textWidth(l)));
  const inner = { width: width - left - 16 };
  const xTicks = axisTicks(panel.x, "x", x.min, x.max, inner.width);
  const lines = Math.max(1, ...xTicks.labels.map(l => l.split("\n").length));
  const below = 10 + 15 * lines + (panel.x.label ? 20 : 4);
  let top = panel.title ? 26 : 8;
  let legend = "", across = left;
  const text = (l, t, content, more = "") => `<text x="${px(l)}" y="${px(t)}" ${more}>${escapeXml(content)}</text>`;
  const named = panel.series.filter(s => s.name && !s.hidden);
  for (const series of named) {
    const wide = 26 + textWidth(series.name) + 16;
    if (across > left && across + wide > width) { across = left; top += 18; }
    legend += keyShapes(series).map(s => svgPath(s, palette, ` transform="translate(${px(across)} ${px(top)})"`)).join("");
    legend += text(across + 24, top + 10, series.name, `fill="${palette.ink}"`);
    across += wide;
  }
  if (named.length) top += 24;
  // As high as on the screen, and on a map of the same shape.
  const screen = plot.inner();
  inner.height = panel.scale ? inner.width * screen.height / screen.width : height - below - 8;
  const at = frameOf(panel, [x.min, x.max], [y.min, y.max], inner.width, inner.height);
  const clip = `clip${panelSvg.count = (panelSvg.count || 0) + 1}`;
  let ground = spans(panel, at).map(([l, r]) => `<rect x="${px(l)}" width="${px(r - l)}" height="${px(inner.height)}" fill="${palette.shade}"/>`).join("");
  let labels = "";
  yTicks.ticks.forEach((tick, i) => {
    const t = px(at.y(tick));
    ground += `<path d="M0 ${t}H${px(inner.width)}" stroke="${palette.grid}"/>`;
    labels += `<path d="M-4 ${t}H0" stroke="${palette.soft}"/>` + text(-8, t + 4, yTicks.labels[i], `text-anchor="end"`);
  });
  xTicks.ticks.forEach((tick, i) => {
    const l = px(at.x(tick));
    if (!panel.x.names.length) ground += `<path d="M${l} 0V${px(inner.height)}" stroke="${palette.grid}"/>`;
    labels += `<path d="M${l} ${px(inner.height)}v4" stroke="${palette.soft}"/>`;
    xTicks.labels[i].split("\n").forEach((line, k) => { labels += text(l, inner.height + 18 + 15 * k, line, `text-anchor="middle"`); });
  });
  const curves = panel.series.filter(s => !s.hidden).flatMap(s => shapes(panel, s, at)).map(s => svgPath(s, palette)).join("");
  const total = top + inner.height + below;
  const axisLabels = text(inner.width / 2, inner.height + below - 6, fit(panel.x.label, inner.width), `text-anchor="middle"`)
    + text(-inner.height / 2, 14 - left, fit(panel.y.label, inner.height), `text-anchor="middle" transform="rotate(-90)"`);
  const body = (panel.title ? text(left, 17, panel.title, `font-weight="600" font-size="14" fill="${palette.ink}"`) : "") + legend
    + `<g transform="translate(${px(left)} ${px(top)})" fill="${palette.soft}">`
    + `<clipPath id="${clip}"><rect width="${px(inner.width)}" height="${px(inner.height)}"/></clipPath>`
    + ground + `<g clip-path="url(#${clip})">${curves}</g>`
    + `<path d="M0 0V${px(inner.height)}H${px(inner.width)}" fill="none" stroke="${palette.soft}"/>${labels}${axisLabels}</g>`;
  return { body, width, height: Math.ceil(total) };
}

const svgFile = (body, width, height, ground) =>
  `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" font-family="system-ui, sans-serif" font-size="12">`
  + (ground ? `<rect width="100%" height="100%" fill="${ground}"/>` : "") + body + "</svg>";

// All panels of a figure, in the columns in which they stand on paper.
function figureSvg(plots, columns, palette) {
  let body = "", left = 0, top = 0, row = 0, width = 0;
  plots.forEach((plot, i) => {
    if (i && i % columns === 0) { left = 0; top += row + 12; row = 0; }
    const panel = panelSvg(plot, palette);
    body += `<g transform="translate(${left} ${top})">${panel.body}</g>`;
    left += panel.width + 12;
    row = Math.max(row, panel.height);
    width = Math.max(width, left - 12);
  });
  return svgFile(body, width, top + row, palette.paper);
}

// Text as spreadsheets take it: numbers with a plain minus and without gaps between their thousands, and
// nothing that they would reckon with as a formula.
function asData(text) {
  const number = text.replace(/(\d)\u202f(?=\d)/g, "$1").replace(/−(?=[\d.])/g, "-");
  if (/^[+-]?[\d.]+(e[+-]?\d+)?$/i.test(number)) return number;
  return /^[=+\-@\t\r]/.test(number) ? "'" + number : number;
}

function csv(rows) {
  const cell = value => {
    const text = value == null ? "" : asData(String(value));
    return /[",\r\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text;
  };
  return rows.map(row => row.map(cell).join(",") + "\r\n").join("");
}

// A column for every series, after one for its x where that is another than before.
function figureCsv(figure) {
  const columns = [];
  for (const panel of figure.panels) {
    const of = name => (figure.panels.length > 1 && panel.title ? `${panel.title}: ${name}` : name);
    let before = null;
    for (const series of panel.series) {
      if (series.x !== before) columns.push([of(panel.x.label || "x"), panel.x.names.length ? Array.from(series.x, i => panel.x.names[i] || i) : series.x]);
      before = series.x;
      const parts = { 2: ["lower", "upper"], 5: ["minimum", "first quartile", "median", "third quartile", "maximum"] }[series.y.length];
      series.y.forEach((column, i) => {
        const name = [series.name || panel.y.label || "y", parts && parts[i]].filter(Boolean).join(", ");
        columns.push([of(name), column]);
      });
    }
  }
  const rows = [columns.map(c => c[0])];
  const count = Math.max(0, ...columns.map(c => c[1].length));
  for (let i = 0; i < count; i++) rows.push(columns.map(c => c[1][i]));
  return csv(rows);
}

function save(name, type, text) {
  const link = make("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

let said;
function say(text) {
  const status = document.getElementById("status");
  status.textContent = text;
  clearTimeout(said);
  said = setTimeout(() => { status.textContent = ""; }, 2000);
}

async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = document.body.appendChild(make("textarea"));
    area.value = text;
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    if (!done) return say("The browser does not allow copying");
  }
  say("Copied");
}

function tools(holder, actions) {
  const bar = holder.appendChild(make("span", "tools"));
  for (const [name, title, action] of actions) {
    const button = bar.appendChild(make("button", "", name));
    button.type = "button";
    button.title = title;
    button.onclick = action;
  }
}

// Evenly spaced values are kept as start, step and count.
const values = stored => Array.isArray(stored) ? stored : Array.from({ length: stored.count }, (_, i) => +(stored.start + i * stored.step).toPrecision(12));

function mountFigure(element, figure, plots) {
  const holder = element.querySelector(".panels");
  // Panels beside a map are as high as the map.
  const shape = panel => {
    const [x, y] = ["x", "y"].map(along => extent(panel, along, -Infinity, Infinity));
    return Math.max(0.5, Math.min(1, (y[1] - y[0]) / (x[1] - x[0])));
  };
  const ratio = Math.max(0, ...figure.panels.filter(p => p.scale).map(shape));
  const own = figure.panels.map(panel => {
    panel.ratio = ratio;
    const link = p => !p.scale && !p.x.names.length ? `${p.x.label} ${p.x.log}` : null;
    const kin = figure.panels.filter(p => link(p) !== null && link(p) === link(panel));
    const key = kin.length > 1 ? `${element.id} ${figure.panels.indexOf(kin[0])}` : null;
    const plot = new Plot(panel, holder.appendChild(make("div", "panel")), key);
    Object.assign(plot, { key, columns: figure.columns });
    return plot;
  });
  for (const plot of own) if (plot.key) plot.kin = own.filter(p => p.key === plot.key);
  plots.push(...own);
  if (own.length) tools(element.querySelector(".caption"), [
    ["SVG", "Save the figure as it is shown", () => save(figure.name + ".svg", "image/svg+xml", figureSvg(own, figure.columns, readPalette("light")))],
    ["CSV", "Save the numbers", () => save(figure.name + ".csv", "text/csv", figureCsv(figure))],
  ]);
}

function start() {
  const data = JSON.parse(document.getElementById("data").textContent);
  const xs = data.x.map(values);
  const sorted = xs.map(x => x.every((v, i) => v != null && (i === 0 || v >= x[i - 1])));
  const plots = [];
  data.figures.forEach((figure, i) => {
    for (const panel of figure.panels) for (const series of panel.series) {
      series.sorted = sorted[series.x];
      series.x = xs[series.x];
    }
    mountFigure(document.getElementById("figure-" + (i + 1)), figure, plots);
  });
  for (const element of document.querySelectorAll("[data-table]")) {
    const rows = () => Array.from(element.querySelectorAll("tr"), row => Array.from(row.cells, c => c.textContent));
    const plain = text => text.replace(/[\t\r\n]+/g, " ");
    tools(element.querySelector(".caption"), [
      ["Copy", "Copy for a spreadsheet", () => copy(rows().map(row => row.map(text => asData(plain(text))).join("\t")).join("\n"))],
      ["CSV", "Save as CSV", () => save(element.dataset.table + ".csv", "text/csv", csv(rows()))],
    ]);
  }

  const system = matchMedia("(prefers-color-scheme: dark)"), root = document.documentElement;
  const dark = () => root.classList.contains("dark") || system.matches && !root.classList.contains("light");
  const button = document.body.appendChild(make("button"));
  button.id = "theme";
  button.type = "button";
  const themed = () => {
    button.textContent = dark() ? "Light" : "Dark";
    button.title = dark() ? "Dark on light" : "Light on dark";
    for (const plot of plots) plot.repaint();
  };
  button.onclick = () => {
    const next = dark() ? "light" : "dark";
    root.classList.remove("light", "dark");
    root.classList.add(next);
    themed();
  };
  system.addEventListener("change", themed);
  button.textContent = dark() ? "Light" : "Dark";

  // On paper every panel is lines and text, not pixels.
  addEventListener("beforeprint", () => {
    const palette = readPalette("light");
    for (const plot of plots) {
      const { body, width, height } = panelSvg(plot, palette, 820 / Math.min(3, plot.columns));
      plot.paper.innerHTML = svgFile(body, width, height);
    }
  });
  addEventListener("afterprint", () => { for (const plot of plots) plot.paper.textContent = ""; });

  // For scripts that look at the page.
  window.report = { plots, ready: performance.now() };
}

start();
