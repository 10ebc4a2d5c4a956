// What a panel looks like at a scale: numbers as text, and every series as paths. A plot on the screen
// and a saved file are drawn from the same paths.
"use strict";

// Colours and widths of lines: style.json of the program.
const DATA = JSON.parse(document.getElementById("data").textContent);
const STYLE = DATA.style;

const SUPER = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

// A number for people: a true minus, powers of ten where there would be many zeros.
function pretty(value, digits) {
  if (value == null || !isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  let text;
  if (size >= 1e-3 && size < 1e6 || digits > 7) text = String(+value.toPrecision(digits));
  if (text === undefined || text.includes("e")) {
    const [mantissa, power] = value.toExponential(Math.min(digits, 7) - 1).split("e");
    const raised = "10" + [...String(+power)].map(c => SUPER[c]).join("");
    text = +mantissa === 1 ? raised : +mantissa === -1 ? "-" + raised : +mantissa + "·" + raised;
  }
  return text.replace("-", "−");
}

// Ticks as text, with as many digits as tell them apart.
function tickLabels(ticks) {
  const size = Math.max(...ticks.map(Math.abs)), step = Math.abs(ticks[1] - ticks[0]) || size;
  const digits = Math.min(15, Math.max(4, Math.ceil(Math.log10(size / step)) + 2));
  return ticks.map(t => pretty(Math.abs(t) < 1e-9 * step ? 0 : t, digits));
}

const wide = series => series.style === "bars" || series.style === "boxes";
const usable = (v, log) => v != null && (!log || v > 0);

// Left and right edge of a bar relative to its x: those of several series at one x are side by side.
function barSlot(panel, series) {
  const kin = panel.series.filter(wide);
  if (panel.gap === undefined) {
    const xs = kin.flatMap(s => Array.from(s.x)).filter(v => v != null).sort((a, b) => a - b);
    panel.gap = xs.slice(1).map((x, i) => x - xs[i]).filter(d => d > 0).reduce((a, b) => Math.min(a, b), Infinity);
    if (!isFinite(panel.gap)) panel.gap = 1;
    panel.shared = xs.some((x, i) => i && x === xs[i - 1]);
  }
  const group = 0.8 * panel.gap, width = panel.shared ? group / kin.length : group;
  const left = (panel.shared ? kin.indexOf(series) * width : 0) - group / 2;
  return [left + 0.04 * width, left + 0.96 * width];
}

// From where to where y goes over the series that are shown, inside [from, to] of x.
function heights(panel, [from, to]) {
  const { log } = panel.y;
  let low = Infinity, high = -Infinity;
  const take = v => { if (v < low) low = v; if (v > high) high = v; };
  for (const s of panel.series) {
    if (s.hidden) continue;
    for (let i = 0; i < s.x.length; i++) {
      const x = s.x[i];
      if (!usable(x, panel.x.log) || !(x >= from && x <= to)) continue;
      for (const column of s.y) if (usable(column[i], log)) take(column[i]);
    }
    if (s.style === "bars" && !log) take(0);
  }
  if (low > high) return log ? [1, 10] : [0, 1];
  const room = 0.05;
  if (low === high) return log ? [low / 2, high * 2] : [low - (Math.abs(low) * 1e-3 || 1), high + (Math.abs(high) * 1e-3 || 1)];
  if (log) { const f = (high / low) ** room; return [low / f, high * f]; }
  return [low - room * (high - low), high + room * (high - low)];
}

const px = v => Math.round(v * 10) / 10;
const LIMIT = 1e5;
const bound = v => Math.max(-LIMIT, Math.min(LIMIT, v));

// A line as path text; what would only go over a column of pixels that is drawn already is left out.
function linePath(series, column, at) {
  const { x } = series, out = [];
  let pen = false, col = NaN, low = 0, high = 0;
  for (let i = 0; i < x.length; i++) {
    if (!usable(x[i], at.logX) || !usable(column[i], at.logY)) { pen = false; continue; }
    const left = bound(at.x(x[i])), top = bound(at.y(column[i])), here = Math.round(left);
    if (pen && here === col) {
      if (low <= top && top <= high) continue;
      low = Math.min(low, top); high = Math.max(high, top);
    } else { low = high = top; }
    out.push((pen ? "L" : "M") + px(left) + " " + px(top));
    pen = true; col = here;
  }
  return out.join("");
}

// Between two columns, a piece for each run without gaps.
function bandPath(series, at) {
  const { x, y: [low, high] } = series;
  let path = "", upper = [], lower = [];
  const flush = () => {
    if (upper.length > 1) path += "M" + upper.concat(lower.reverse()).join("L") + "Z";
    upper = []; lower = [];
  };
  for (let i = 0; i < x.length; i++) {
    if (!usable(x[i], at.logX) || !usable(low[i], at.logY) || !usable(high[i], at.logY)) { flush(); continue; }
    const left = px(bound(at.x(x[i])));
    upper.push(left + " " + px(bound(at.y(high[i]))));
    lower.push(left + " " + px(bound(at.y(low[i]))));
  }
  flush();
  return path;
}

// The paths of a series: { d, fill or stroke, width, dash, alpha } in pixels of the plot.
function shapes(panel, series, at) {
  const colour = series.colour;
  const rect = (l, t, r, b) => `M${px(l)} ${px(t)}H${px(r)}V${px(b)}H${px(l)}Z`;
  const zero = () => bound(at.logY ? at.height : at.y(0));
  switch (series.style) {
    case "dashed": return [{ d: linePath(series, series.y[0], at), stroke: colour, width: STYLE.widths.dashed, dash: STYLE.dash.split(",").map(Number) }];
    case "band": return [{ d: bandPath(series, at), fill: colour, alpha: STYLE.tint }];
    case "points": case "dots": {
      let d = "", rings = "";
      const sigma = series.sigma, across = sigma ? Math.abs(at.x(1) - at.x(0)) : 0;
      series.x.forEach((x, i) => {
        const y = series.y[0][i];
        if (!usable(x, at.logX) || !usable(y, at.logY)) return;
        const l = at.x(x), t = at.y(y), [rx, ry] = sigma ? sigma.map(column => px(across * column[i])) : [5, 5];
        if (!(l > -rx - 5 && l < at.width + rx + 5 && t > -ry - 5 && t < at.height + ry + 5)) return;
        d += `M${px(l)} ${px(t)}h.01`;
        // One standard deviation, where that is more than the dot.
        if (sigma && Math.max(rx, ry) > 3 && rx + ry < LIMIT) rings += `M${px(l - rx)} ${px(t)}a${rx} ${ry} 0 1 0 ${2 * rx} 0a${rx} ${ry} 0 1 0 ${-2 * rx} 0`;
      });
      const dots = { d, stroke: colour, width: series.style === "dots" ? STYLE.dot : STYLE.widths.points, cap: "round" };
      return rings ? [{ d: rings, stroke: colour, width: STYLE.widths.thin, alpha: 0.6 }, dots] : [dots];
    }
    case "bars": {
      const [from, to] = barSlot(panel, series);
      let d = "";
      series.x.forEach((x, i) => {
        const y = series.y[0][i];
        if (x != null && usable(y, at.logY)) d += rect(bound(at.x(x + from)), zero(), bound(at.x(x + to)), bound(at.y(y)));
      });
      return [{ d, fill: colour }];
    }
    case "boxes": {
      const [from, to] = barSlot(panel, series);
      let area = "", lines = "", medians = "";
      series.x.forEach((x, i) => {
        const levels = series.y.map(column => column[i]);
        if (x == null || !levels.every(v => usable(v, at.logY))) return;
        const [low, q1, median, q3, high] = levels.map(v => px(bound(at.y(v))));
        const l = px(bound(at.x(x + from))), r = px(bound(at.x(x + to))), m = px((l + r) / 2);
        area += rect(l, q3, r, q1);
        lines += rect(l, q3, r, q1) + `M${m} ${q1}V${low}M${m} ${q3}V${high}`;
        medians += `M${l} ${median}H${r}`;
      });
      return [{ d: area, fill: colour, alpha: STYLE.tint }, { d: lines, stroke: colour, width: STYLE.widths.thin }, { d: medians, stroke: colour, width: STYLE.widths.thick }];
    }
  }
  return [{ d: linePath(series, series.y[0], at), stroke: colour, width: STYLE.widths[series.style], dash: series.dash && STYLE.dashes[series.dash % STYLE.dashes.length].split(",").map(Number) }];
}

// Scale bar, about a fifth of the width, and north arrow of a map: a path and texts, where their middle is.
function mapMarks(at) {
  const metres = (at.width / 5) / Math.abs(at.x(1) - at.x(0)), power = 10 ** Math.floor(Math.log10(metres));
  const length = [5, 2, 1].map(m => m * power).find(m => m <= metres) || power, wide = length * Math.abs(at.x(1) - at.x(0));
  if (!(wide > 0 && wide < at.width)) return { d: "", texts: [] };
  const bottom = at.height - 12;
  const label = length >= 1000 ? pretty(length / 1000, 4) + " km" : length >= 1 ? pretty(length, 4) + " m" : pretty(length * 100, 4) + " cm";
  return { d: `M12 ${px(bottom - 5)}v5h${px(wide)}v-5M18 46V24l-5 9M18 24l5 9`, texts: [[px(12 + wide / 2), px(bottom - 6), label], [18, 18, "N"]] };
}

const escapeXml = text => String(text).replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f\ufffe\uffff]/g, "").replace(/[<>&"']/g, c => `&#${c.charCodeAt(0)};`);

// A path as an SVG element, its colours those of the palette given.
function svgPath({ d, fill, stroke, width, dash, cap, alpha }, palette) {
  if (!d) return "";
  const paint = fill === undefined
    ? `fill="none" stroke="${palette[stroke]}" stroke-width="${width}" stroke-linejoin="round"${dash ? ` stroke-dasharray="${dash}"` : ""}${cap ? ` stroke-linecap="${cap}"` : ""}`
    : `fill="${palette[fill]}"`;
  return `<path d="${d}" ${paint}${alpha ? ` opacity="${alpha}"` : ""}/>`;
}
