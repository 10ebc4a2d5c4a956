// Axes of a plot on the screen: ticks and labels that have room.
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

// Names below an axis stand upright where they would be cut short beside each other.
function namesUpright(names, room) {
  return names.some(name => wrapName(name, room).split("\n").some(line => line.endsWith("…") && !name.endsWith("…")));
}

// Ticks of an axis and their labels, for a length in pixels: as many as stand apart.
function axisTicks(axis, along, min, max, length) {
  if (axis.names.length) {
    const ticks = axis.names.map((_, i) => i).filter(i => i >= min && i <= max);
    const room = length / (max - min) - 8;
    const upright = namesUpright(axis.names, room);
    return { ticks, upright, labels: ticks.map(i => upright ? fit(axis.names[i], 150) : wrapName(axis.names[i], room)) };
  }
  const at = mapper(min, max, axis.log, 0, length);
  const room = STYLE.ticks[along];
  let most = Math.max(1, Math.min(room.most, Math.floor(length / room.pixels)));
  for (;; most--) {
    const ticks = axis.log ? logTicks(min, max, most) : linearTicks(min, max, most);
    const labels = tickLabels(ticks);
    const apart = along === "y" || labels.every((label, i) => !i || at(ticks[i]) - at(ticks[i - 1]) > (textWidth(label) + textWidth(labels[i - 1])) / 2 + 12);
    if (apart || most <= 1) return { ticks, labels };
  }
}

function mapper(min, max, log, from, to) {
  if (!log) { const k = (to - from) / (max - min); return v => from + (v - min) * k; }
  const k = (to - from) / Math.log(max / min);
  return v => from + Math.log(v / min) * k;
}
