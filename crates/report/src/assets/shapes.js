// What a panel looks like at a scale: ticks, and every series as paths. A plot on the screen and a
// saved file are drawn from the same paths.
"use strict";

// At most so many multiples of 1, 2 or 5 times a power of ten.
function linearTicks(min, max, most) {
  const span = max - min;
  if (!(span > 0 && span < Infinity)) return [];
  const power = 10 ** Math.floor(Math.log10(span / most));
  const step = [1, 2, 5, 10].map(m => m * power).find(s => span / s <= most) || 10 * power;
  const ticks = [];
  const first = Math.ceil(min / step - 1e-9);
  for (let i = 0; i <= most && (first + i) * step <= max + 1e-9 * step; i++) ticks.push((first + i) * step);
  return ticks;
}

// Powers of ten, every n-th where they are many; where they are few, values between too.
function logTicks(min, max, most) {
  const first = Math.floor(Math.log10(min)), last = Math.ceil(Math.log10(max)), span = Math.log10(max / min);
  if (!(span > 0 && span < Infinity)) return [];
  const between = span < 0.8 ? [1, 1.5, 2, 3, 4, 5, 6, 8] : span * 3 <= most + 1 ? [1, 2, 5] : span * 2 <= most + 1 ? [1, 3] : [1];
  const every = Math.max(1, Math.ceil(span / most));
  const ticks = [];
  for (let p = first; p <= last; p += 1) {
    if (p % every) continue;
    for (const m of between) {
      const tick = m * 10 ** p;
      if (tick >= min * (1 - 1e-9) && tick <= max * (1 + 1e-9)) ticks.push(tick);
    }
  }
  return ticks.length > 1 ? ticks : linearTicks(min, max, most).filter(t => t > 0);
}

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

// From where to where a bar stands beside its x: those of several series at one x stand side by side.
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

// The least and greatest value of an axis over the series that are shown, inside [from, to] of x; of a
// part of them even where the axis has a range of its own.
function extent(panel, axis, from, to, part = false) {
  const along = axis === "x", own = panel[axis];
  if (own.range && !part) return own.range.slice();
  let low = Infinity, high = -Infinity;
  const take = v => { if (v < low) low = v; if (v > high) high = v; };
  for (const s of panel.series) {
    if (s.hidden && !along) continue;
    const slot = along && wide(s) ? barSlot(panel, s) : [0];
    for (let i = 0; i < s.x.length; i++) {
      const x = s.x[i];
      if (!usable(x, panel.x.log) || !(x >= from && x <= to)) continue;
      for (const column of s.y) {
        const y = column[i];
        if (!usable(y, panel.y.log)) continue;
        if (along) slot.forEach(d => usable(x + d, own.log) && take(x + d));
        else take(y);
      }
    }
    if (!along && s.style === "bars" && !own.log) take(0);
  }
  if (low > high) return own.log ? [1, 10] : [0, 1];
  const room = !along ? 0.05 : panel.series.some(s => s.style === "dots") ? 0.01 : 0;
  if (low === high) return own.log ? [low / 2, high * 2] : [low - (Math.abs(low) * 1e-3 || 1), high + (Math.abs(high) * 1e-3 || 1)];
  if (own.log) { const f = (high / low) ** room; return [low / f, high * f]; }
  return [low - room * (high - low), high + room * (high - low)];
}

const px = v => Math.round(v * 10) / 10;
const LIMIT = 1e5;
const bound = v => Math.max(-LIMIT, Math.min(LIMIT, v));

// A line as path text; where many points fall on one column of pixels, its ends and extremes only.
function linePath(series, column, at) {
  const { x } = series, n = x.length;
  const thin = n > 4 * at.width;
  const out = [];
  let pen = false, col = NaN, first = 0, last = 0, low = 0, high = 0;
  const flush = () => {
    if (col !== col) return;
    out.push("L" + col + " " + px(first));
    if (low < first) out.push("L" + col + " " + px(low));
    if (high > first) out.push("L" + col + " " + px(high));
    if (last !== high && last !== first) out.push("L" + col + " " + px(last));
    col = NaN;
  };
  for (let i = 0; i < n; i++) {
    if (!usable(x[i], at.logX) || !usable(column[i], at.logY)) { flush(); pen = false; continue; }
    const left = bound(at.x(x[i])), top = bound(at.y(column[i]));
    if (!pen) { flush(); out.push("M" + px(left) + " " + px(top)); pen = true; continue; }
    if (!thin) { out.push("L" + px(left) + " " + px(top)); continue; }
    const here = Math.round(left);
    if (here === col) { last = top; if (top < low) low = top; if (top > high) high = top; }
    else { flush(); col = here; first = last = low = high = top; }
  }
  flush();
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
    case "line": return [{ d: linePath(series, series.y[0], at), stroke: colour, width: series.width }];
    case "dashed": return [{ d: linePath(series, series.y[0], at), stroke: colour, width: 1.6, dash: [6, 4] }];
    case "band": return [{ d: bandPath(series, at), fill: colour, alpha: 0.2 }];
    case "dots": {
      let d = "";
      series.x.forEach((x, i) => {
        const y = series.y[0][i];
        if (!usable(x, at.logX) || !usable(y, at.logY)) return;
        const l = at.x(x), t = at.y(y);
        if (l > -5 && l < at.width + 5 && t > -5 && t < at.height + 5) d += `M${px(l - 2.5)} ${px(t)}a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0`;
      });
      return [{ d, fill: colour, alpha: 0.85 }];
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
      return [{ d: area, fill: colour, alpha: 0.2 }, { d: lines, stroke: colour, width: 1 }, { d: medians, stroke: colour, width: 2.5 }];
    }
  }
  return [];
}

// The sample of a series beside its name, as path on 18 by 12 pixels.
function keyShapes(series) {
  const stroke = series.colour;
  switch (series.style) {
    case "line": return [{ d: "M0 6H18", stroke, width: series.width }];
    case "dashed": return [{ d: "M0 6H18", stroke, width: 1.6, dash: [6, 4] }];
    case "dots": return [{ d: "M6 6a3 3 0 1 0 6 0a3 3 0 1 0 -6 0", fill: stroke }];
    case "bars": return [{ d: "M3 1H15V11H3Z", fill: stroke }];
    case "boxes": return [{ d: "M3 1H15V11H3Z", fill: stroke, alpha: 0.2 }, { d: "M3 1H15V11H3ZM3 6H15", stroke, width: 1.5 }];
    default: return [{ d: "M0 1H18V11H0Z", fill: stroke, alpha: 0.2 }];
  }
}

const escapeXml = text => String(text).replace(/[\u0000-\u0008\u000b\u000c\u000e-\u001f\ufffe\uffff]/g, "").replace(/[<>&"']/g, c => `&#${c.charCodeAt(0)};`);

// A path as an SVG element, its colours those of the palette given.
function svgPath({ d, fill, stroke, width, dash, alpha }, palette, move = "") {
  if (!d) return "";
  const paint = fill === undefined
    ? `fill="none" stroke="${palette[stroke]}" stroke-width="${width}" stroke-linejoin="round"${dash ? ` stroke-dasharray="${dash}"` : ""}`
    : `fill="${palette[fill]}"`;
  return `<path d="${d}" ${paint}${alpha ? ` opacity="${alpha}"` : ""}${move}/>`;
}
