// Axes of a plot on the screen: ticks and labels that have room. Linear ticks are uPlot's own.
"use strict";

const FONT = "12px system-ui, sans-serif";
const ruler = document.createElement("canvas").getContext("2d");
function textWidth(text, font = FONT) {
  ruler.font = font;
  return ruler.measureText(text).width;
}

// Text as long as there is room.
function fit(text, room) {
  if (textWidth(text) <= room) return text;
  let n = text.length;
  while (n > 1 && textWidth(text.slice(0, n) + "…") > room) n--;
  return text.slice(0, n) + "…";
}

// A name in at most three lines that fit beside its neighbours.
function wrapName(name, room) {
  const lines = [];
  for (const word of name.split(/(?<=[-–/])|(?<=\s)/)) {
    const joined = (lines[lines.length - 1] || "") + word;
    if (lines.length && textWidth(joined.trim()) <= room) lines[lines.length - 1] = joined;
    else lines.push(word);
  }
  const shown = lines.slice(0, 3).map(line => fit(line.trim(), room));
  if (lines.length > 3) shown[2] = shown[2].replace(/…?$/, "…");
  return shown.join("\n");
}

// Names below an axis with so much room for each: in lines, or all upright where they would be cut short beside each other.
function nameLabels(names, room) {
  const labels = names.map(name => wrapName(name, room));
  const upright = names.some((name, i) => !name.endsWith("…") && /…$/m.test(labels[i]));
  return { upright, labels: upright ? names.map(name => fit(name, 150)) : labels };
}

// Pixels between ticks: ten of x at most, which leave room between their labels.
function tickSpace(u, i, min, max, length) {
  if (u.axes[i].scale === "y") return 32;
  const power = 10 ** Math.floor(Math.log10((max - min) / 5));
  const ends = u.scales.x.distr === 3 ? [] : tickLabels([Math.ceil(min / power) * power, Math.floor(max / power) * power]);
  return Math.max(46, length / 10, ...ends.map(label => textWidth(label) + 12));
}

// Ticks of a logarithmic axis, where uPlot's own begin at its end, round or not: round numbers of every n-th power of ten, within
// one multiples of the step of a linear axis.
function logSplits(u, i, min, max, step, space) {
  const decade = lengthOf(u, u.axes[i].scale) / Math.log10(max / min), ticks = [];
  if (max < 10 * min) for (let k = Math.ceil(min / step); k * step <= max; k++) ticks.push(k * step);
  else {
    const at = [[1, 2, 5], [1, 3], [1]].find(at => at.length === 1 || decade * Math.log10(at[1]) >= space);
    const every = Math.ceil(space / decade);
    for (let p = every * Math.ceil((Math.log10(min) - 1) / every); 10 ** p <= max; p += every) ticks.push(...at.map(m => m * 10 ** p));
  }
  return ticks.filter(tick => tick >= min * (1 - 1e-9) && tick <= max * (1 + 1e-9));
}

function mapper(min, max, log, from, to) {
  if (!log) { const k = (to - from) / (max - min); return v => from + (v - min) * k; }
  const k = (to - from) / Math.log(max / min);
  return v => from + Math.log(v / min) * k;
}
