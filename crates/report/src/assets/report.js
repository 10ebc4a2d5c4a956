// The page: figures from the data, files to save, themes, paper.
"use strict";

// Figures are SVG until this runs, and on paper.
root.classList.add("live");

// All panels of a figure in its columns, as an SVG file.
function figureSvg(plots, columns) {
  const GAP = 14, element = name => document.createElementNS("http://www.w3.org/2000/svg", name);
  const { width, height } = plots[0].first.viewBox.baseVal, across = Math.min(columns, plots.length), down = Math.ceil(plots.length / across);
  const file = plots[0].first.cloneNode(), size = [across * (width + GAP) - GAP, down * (height + GAP) - GAP];
  file.removeAttribute("class");
  ["width", "height"].forEach((name, i) => file.setAttribute(name, size[i]));
  file.setAttribute("viewBox", "0 0 " + size.join(" "));
  const paper = file.appendChild(element("rect"));
  for (const [name, value] of [["width", "100%"], ["height", "100%"], ["fill", STYLE.inks.paper[0]]]) paper.setAttribute(name, value);
  plots.forEach((plot, i) => {
    const group = file.appendChild(element("g"));
    group.setAttribute("transform", `translate(${i % across * (width + GAP)} ${Math.floor(i / across) * (height + GAP)})`);
    group.append(...plot.onPaper().cloneNode(true).childNodes);
  });
  return { text: new XMLSerializer().serializeToString(file), size };
}

// The same as a picture of twice as many pixels.
async function savePng(name, { text, size: [width, height] }) {
  const image = new Image(), canvas = make("canvas");
  image.src = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  await image.decode();
  Object.assign(canvas, { width: 2 * width, height: 2 * height });
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  URL.revokeObjectURL(image.src);
  canvas.toBlob(blob => save(name, "image/png", blob));
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
  const holders = element.querySelectorAll(".panel");
  // Panels beside a map are as high as the map.
  const shape = ({ x: { range: x }, y: { range: y } }) => Math.max(0.5, Math.min(1, (y[1] - y[0]) / (x[1] - x[0])));
  const ratio = Math.max(0, ...figure.panels.filter(p => p.scale).map(shape));
  const own = figure.panels.map((panel, i) => {
    panel.ratio = ratio;
    const link = p => p.clock == null && !p.scale && !p.x.names.length ? `${p.x.label} ${p.x.log}` : null;
    const kin = figure.panels.filter(p => link(p) !== null && link(p) === link(panel));
    const key = kin.length > 1 ? `${element.id} ${figure.panels.indexOf(kin[0])}` : null;
    return Object.assign(new Plot(panel, holders[i], key), { key });
  });
  for (const plot of own) if (plot.key) plot.kin = own.filter(p => p.key === plot.key);
  plots.push(...own);
  if (own.length) tools(element.querySelector(".caption"), [
    ["SVG", "Save the figure as it is shown", () => save(figure.name + ".svg", "image/svg+xml", figureSvg(own, figure.columns).text)],
    ["PNG", "Save the figure as it is shown, as pixels", () => savePng(figure.name + ".png", figureSvg(own, figure.columns))],
    ["CSV", "Save the numbers", () => save(figure.name + ".csv", "text/csv", figureCsv(figure))],
  ]);
}

function start() {
  const xs = DATA.x.map(values);
  const sorted = xs.map(x => x.every((v, i) => v != null && (i === 0 || v >= x[i - 1])));
  const plots = [];
  DATA.figures.forEach((figure, i) => {
    for (const panel of figure.panels) for (const series of panel.series) {
      series.sorted = sorted[series.x];
      series.x = xs[series.x];
      if (series.t === undefined) continue;
      series.t = xs[series.t];
      // How far from a time a place still is of that time.
      const steps = series.t.slice(1).map((t, i) => t - series.t[i]).sort((a, b) => a - b);
      series.apart = Math.max(0.5, 2 * (steps[steps.length >> 1] || 0));
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

  const button = document.body.appendChild(make("button"));
  button.id = "theme";
  button.type = "button";
  const themed = () => {
    button.textContent = isDark() ? "Light" : "Dark";
    button.title = isDark() ? "Dark on light" : "Light on dark";
    for (const plot of plots) plot.repaint();
  };
  button.onclick = () => {
    const next = isDark() ? "light" : "dark";
    root.classList.remove("light", "dark");
    root.classList.add(next);
    themed();
  };
  system.addEventListener("change", themed);
  button.textContent = isDark() ? "Light" : "Dark";

  // What is folded is on paper too.
  let folded = [];
  addEventListener("beforeprint", () => {
    folded = [...document.querySelectorAll("details:not([open])")];
    for (const details of folded) details.open = true;
    for (const plot of plots) plot.print();
  });
  addEventListener("afterprint", () => {
    for (const details of folded) details.open = false;
    for (const plot of plots) plot.print(plot.first);
  });
  // A link into what is folded unfolds it.
  const unfold = () => document.getElementById(location.hash.slice(1))?.closest("details")?.setAttribute("open", "");
  addEventListener("hashchange", unfold);
  unfold();
  if (plots.length) document.querySelector("nav").appendChild(make("p", "hint", "Drag over a figure to zoom, double click to show all. Ctrl and the wheel zoom; after a click the wheel alone. Shift and drag moves."));

  // For scripts that look at the page.
  window.report = { plots, ready: performance.now() };
}

start();
