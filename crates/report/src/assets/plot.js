// One panel on the screen: axes, cursor and zoom are uPlot's, the legend and the curves our own.
"use strict";

// The colours on a light ground or a dark one.
function palette(dark) {
  const side = pair => pair[dark ? 1 : 0];
  return Object.assign(STYLE.colours.map(side), Object.fromEntries(Object.entries(STYLE.inks).map(([name, pair]) => [name, side(pair)])));
}
const system = matchMedia("(prefers-color-scheme: dark)"), root = document.documentElement;
const isDark = () => root.classList.contains("dark") || system.matches && !root.classList.contains("light");

// From values to pixels of the plot.
function frameOf(panel, x, y, width, height) {
  return {
    x: mapper(x[0], x[1], panel.x.log, 0, width), y: mapper(y[0], y[1], panel.y.log, height, 0),
    logX: panel.x.log, logY: panel.y.log, width, height,
  };
}

function nearestIndex(x, value) {
  let low = 0, high = x.length - 1;
  while (high - low > 1) {
    const mid = (low + high) >> 1;
    if (x[mid] < value) low = mid; else high = mid;
  }
  return Math.abs(x[low] - value) <= Math.abs(x[high] - value) ? low : high;
}

const lengthOf = (u, along) => (along === "x" ? u.bbox.width : u.bbox.height) / devicePixelRatio;
const heightOf = (panel, width) => Math.round(Math.max(240, Math.min(panel.ratio ? 560 : 360, width * (panel.ratio || 0.5) + 50)) + (panel.x.names.length && width < 500 ? 70 : 0));

// Plots over time and maps whose places have times: a cursor in one or a part of time zoomed into shows in all. What was
// shared last is shown in the next frame, once.
const linked = [];
let shared = null;
function share(source, what) {
  if (!shared) requestAnimationFrame(() => {
    const { source, time, span } = shared;
    shared = null;
    for (const plot of linked) if (plot !== source) {
      if (span !== undefined) plot.zoomSpan(span);
      if (time !== undefined) plot.showTime(time);
    }
  });
  shared = { ...shared, source, ...what };
}

class Plot extends Gestures {
  constructor(panel, holder, key) {
    super();
    Object.assign(this, { panel, holder, kin: [this], zoom: null, first: holder.querySelector(".paper"), palette: palette(isDark()) });
    this.paper = this.first;
    this.buildLegend();
    this.box = holder.appendChild(make("div", "plot screen"));
    this.where = this.box.appendChild(make("span", "x"));
    const { width, height } = this.size();
    const axis = along => ({
      scale: along, side: along === "x" ? 2 : 3, label: panel[along].label ? u => fit(panel[along].label, lengthOf(u, along)) : undefined, labelSize: panel[along].label ? 22 : 0,
      font: FONT, labelFont: FONT, labelGap: 2, gap: 4, space: tickSpace,
      stroke: () => this.palette.soft,
      grid: { stroke: () => this.palette.grid, width: 1, show: !(along === "x" && panel.x.names.length) },
      ticks: { stroke: () => this.palette.rule, width: 1, size: 4 },
      border: { show: true, stroke: () => this.palette.soft, width: 1 },
      splits: panel[along].names.length ? (u, _, min, max) => [...panel.x.names.keys()].filter(i => i >= min && i <= max) : panel[along].log ? logSplits : undefined,
      filter: (_, splits) => splits,
      values: (u, splits) => panel[along].names.length ? splits.map(i => this.names(u).labels[i]) : tickLabels(splits),
      rotate: u => along === "x" && this.names(u).upright ? 90 : 0,
      size: (u, labels) => along === "y" || this.names(u).upright
        ? 12 + Math.max(12, ...(labels || []).map(l => textWidth(l)))
        : 12 + 15 * Math.max(1, ...(labels || []).map(l => String(l).split("\n").length)),
    });
    const [x, y] = this.ranges(width, height);
    const scale = (own, [min, max]) => ({ time: false, distr: own.log ? 3 : 1, min, max, range: (_, a, b) => [a, b] });
    this.u = new uPlot({
      width, height, padding: [8, 20, 0, 0],
      scales: { x: scale(panel.x, x), y: scale(panel.y, y) },
      series: [{}, { show: true }],
      axes: [axis("x"), axis("y")],
      legend: { show: false },
      cursor: {
        points: { show: false },
        drag: { x: true, y: panel.scale, setScale: false },
        sync: key ? { key, scales: ["x", null], filters: { pub: type => type === "mousemove" } } : undefined,
        bind: { dblclick: () => () => this.setZoom(null) },
      },
      hooks: {
        drawClear: [() => this.drawGround()],
        draw: [() => this.drawCurves()],
        setCursor: [() => this.pointed()],
        setSelect: [u => this.selected(u)],
      },
    }, [x, [null, null]], this.box);
    // A page inside another keeps to that one's policy, which forbids tiles.
    if (panel.origin && /^(file|https?):$/.test(location.protocol)) this.background = new Background(this);
    this.bindTouch();
    this.bindKeys();
    this.bindWheel();
    this.u.root.setAttribute("role", "img");
    this.u.root.setAttribute("aria-label", this.first.getAttribute("aria-label") + " Plus and minus zoom, arrows move, with Shift the cursor, 0 shows all.");
    this.marks = panel.series.map(series => {
      const mark = make("span", "mark");
      mark.style.background = `var(--c${series.colour})`;
      mark.hidden = true;
      return this.u.over.appendChild(mark);
    });
    this.reset = this.box.appendChild(make("button", "reset", "Reset zoom"));
    this.reset.hidden = true;
    // Over time, or a map that knows when it was where.
    this.linked = panel.clock != null && (!panel.scale || panel.series.some(s => s.t));
    if (this.linked) linked.push(this);
    this.reset.onclick = () => this.setZoom(null);
    if (panel.scale) this.refresh();
    new ResizeObserver(() => this.resize()).observe(holder);
  }

  size() {
    const width = Math.max(200, Math.floor(this.holder.clientWidth));
    return { width, height: heightOf(this.panel, width) };
  }

  resize() {
    // On paper a plot is not shown: it has no size, and asks for no other tiles.
    if (!this.box.clientWidth) return;
    const { width, height } = this.size();
    if (width === this.u.width && height === this.u.height) return;
    this.u.setSize({ width, height });
    if (this.panel.scale) queueMicrotask(() => this.refresh());
  }

  // What is seen: the part zoomed into or all, y as high as the curves there.
  ranges(width, height) {
    const { panel, zoom } = this;
    let x = zoom ? zoom.x : panel.x.range;
    const other = zoom || !panel.y.fixed && panel.series.some(s => s.hidden);
    let y = zoom && zoom.y || (other ? heights(panel, x) : panel.y.range);
    if (panel.scale) {
      const pixel = 1.04 * Math.max((x[1] - x[0]) / width, (y[1] - y[0]) / height);
      const around = ([a, b], n) => [(a + b - pixel * n) / 2, (a + b + pixel * n) / 2];
      x = around(x, width);
      y = around(y, height);
    }
    return [x, y];
  }

  refresh() {
    // Other labels leave the plot another width, and then a map has another scale.
    for (let round = 0; round < 4; round++) {
      const { width, height } = this.inner();
      const [x, y] = this.ranges(width, height);
      this.u.batch(() => {
        this.u.setScale("x", { min: x[0], max: x[1] });
        this.u.setScale("y", { min: y[0], max: y[1] });
      });
      const after = this.inner();
      if (!this.panel.scale || after.width === width && after.height === height) break;
    }
    this.reset.hidden = !this.zoom;
  }

  // Zooms here and in what is over the same x; over time also the maps, to what lies in that span.
  setZoom(zoom) {
    const { clock, scale } = this.panel;
    if (this.linked && (!scale || !zoom)) share(this, { span: zoom && zoom.x.map(v => v + clock) });
    const kin = this.linked ? [this] : this.kin;
    for (const plot of kin) { plot.zoom = zoom; plot.refresh(); }
  }

  zoomSpan(span) {
    const { scale, clock, x: { range: [start, end] } } = this.panel;
    const [from, to] = span ? span.map(t => t - clock) : [];
    if (!span) this.zoom = null;
    else if (scale) this.zoom = this.placesIn(from, to);
    else this.zoom = from < end && to > start ? { x: [from, to] } : null;
    this.refresh();
  }

  // The part of a map where it was in a span of time.
  placesIn(from, to) {
    const x = [Infinity, -Infinity], y = [Infinity, -Infinity];
    const take = (range, v) => { range[0] = Math.min(range[0], v); range[1] = Math.max(range[1], v); };
    for (const s of this.panel.series) if (s.t && !s.hidden) s.t.forEach((t, i) => {
      if (t >= from && t <= to && s.x[i] != null && s.y[0][i] != null) { take(x, s.x[i]); take(y, s.y[0][i]); }
    });
    if (!(x[1] >= x[0])) return this.zoom;
    const room = 1 + 0.1 * Math.max(x[1] - x[0], y[1] - y[0]), wider = ([a, b]) => [a - room, b + room];
    return { x: wider(x), y: wider(y) };
  }

  // Zooms by a factor about a place and moves, both in shares of the plot.
  change(factor, about = [0.5, 0.5], move = [0, 0]) {
    const { u, panel } = this, all = panel.x.range;
    if (!this.zoom && factor >= 1) return;
    const part = (along, at, by) => {
      const { log } = panel[along], to = v => log ? Math.log(v) : v, back = v => log ? Math.exp(v) : v;
      const { min, max } = u.scales[along], a = to(min), span = to(max) - a;
      let low = a + (at - at * factor + by) * span, high = low + factor * span;
      if (along === "x" && !panel.scale) {
        const [first, last] = all.map(to), shift = Math.max(0, first - low) - Math.max(0, high - last);
        low = Math.max(first, low + shift);
        high = Math.min(last, high + shift);
      }
      return [back(low), back(high)];
    };
    const x = part("x", about[0], move[0]);
    const whole = factor > 1 && x[0] <= all[0] && x[1] >= all[1];
    const fine = (x[1] - x[0]) > 1e-9 * Math.max(Math.abs(x[0]), Math.abs(x[1]));
    if (whole) this.setZoom(null);
    else if (fine) this.setZoom(panel.scale ? { x, y: part("y", about[1], move[1]) } : { x });
  }

  selected(u) {
    const { left, top, width, height } = u.select;
    if (width < 4 && (!this.panel.scale || height < 4)) return;
    const zoom = { x: [u.posToVal(left, "x"), u.posToVal(left + width, "x")] };
    if (this.panel.scale) zoom.y = [u.posToVal(top + height, "y"), u.posToVal(top, "y")];
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    if (zoom.x[1] > zoom.x[0] && (!zoom.y || zoom.y[1] > zoom.y[0])) this.setZoom(zoom);
  }

  inner() {
    const { bbox } = this.u;
    return { width: bbox.width / devicePixelRatio, height: bbox.height / devicePixelRatio };
  }

  frame() {
    const { x, y } = this.u.scales, { width, height } = this.inner();
    return frameOf(this.panel, [x.min, x.max], [y.min, y.max], width, height);
  }

  // Draws in pixels of the plot.
  within(draw) {
    const { ctx, bbox } = this.u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.translate(bbox.left, bbox.top);
    ctx.scale(devicePixelRatio, devicePixelRatio);
    draw(ctx, this.frame());
    ctx.restore();
  }

  drawGround() {
    this.within((ctx, at) => {
      for (const [ink, l, r] of spans(this.panel, at)) {
        ctx.fillStyle = this.palette[ink];
        ctx.fillRect(l, 0, r - l, at.height);
      }
    });
  }

  drawCurves() {
    this.within((ctx, at) => {
      ctx.lineJoin = "round";
      for (const series of this.panel.series) {
        if (series.hidden) continue;
        for (const { d, fill, stroke, width, dash, cap, alpha } of shapes(this.panel, series, at)) {
          const path = new Path2D(d);
          ctx.globalAlpha = alpha || 1;
          ctx.setLineDash(dash || []);
          ctx.lineCap = cap || "butt";
          if (fill !== undefined) { ctx.fillStyle = this.palette[fill]; ctx.fill(path); }
          else { ctx.strokeStyle = this.palette[stroke]; ctx.lineWidth = width; ctx.stroke(path); }
        }
      }
    });
    if (this.panel.scale) this.within((ctx, at) => {
      const { d, texts } = mapMarks(at);
      ctx.strokeStyle = ctx.fillStyle = this.palette.soft;
      ctx.lineWidth = 1.5;
      ctx.font = FONT;
      ctx.textAlign = "center";
      ctx.stroke(new Path2D(d));
      for (const [x, y, text] of texts) ctx.fillText(text, x, y);
    });
    if (this.background) this.background.moved();
    this.drawn = (this.drawn || 0) + 1;
  }

  repaint() {
    this.palette = palette(isDark());
    this.u.redraw(false, false);
  }

  buildLegend() {
    const { panel, holder } = this;
    if (panel.title) holder.appendChild(make("h3", "screen", panel.title));
    this.legend = holder.appendChild(make("ul", "legend screen"));
    this.outputs = panel.series.map((series, i) => {
      if (!series.name) return null;
      const button = make("button");
      button.type = "button";
      button.setAttribute("aria-pressed", "true");
      button.title = "Show or hide";
      // The sample of the first view, in the colours of the page.
      button.innerHTML = `<svg width="18" height="12" aria-hidden="true"></svg>`;
      for (const part of this.first.querySelectorAll(`[data-series="${i}"] path`)) {
        const sample = button.firstChild.appendChild(part.cloneNode());
        for (const paint of ["fill", "stroke"]) if (sample.hasAttribute(paint) && sample.getAttribute(paint) !== "none") sample.setAttribute(paint, `var(--c${series.colour})`);
      }
      button.appendChild(make("span", "", series.name));
      const output = button.appendChild(make("output"));
      // Room for its values, so that the page does not move when they appear.
      output.style.minWidth = (series.y.length === 2 ? 19 : series.y.length === 5 || panel.scale ? 17 : 8) + "ch";
      button.onclick = () => this.toggle(series, button);
      this.legend.appendChild(make("li")).appendChild(button);
      return output;
    });
  }

  toggle(series, button) {
    series.hidden = !series.hidden;
    // A band without a name belongs to the curve after it.
    const { series: all } = this.panel;
    for (let i = all.indexOf(series) - 1; i >= 0 && !all[i].name && all[i].colour === series.colour; i--) all[i].hidden = series.hidden;
    button.setAttribute("aria-pressed", String(!series.hidden));
    this.refresh();
    this.u.redraw(false, false);
  }

  // The panel on paper: the first view as it came, or with those parts drawn again that are seen otherwise.
  onPaper() {
    const { panel, first } = this;
    if (!this.zoom && !panel.series.some(s => s.hidden)) return first;
    const view = first.cloneNode(true), colours = palette(false);
    const [width, height] = view.querySelector("[data-size]").dataset.size.split(" ").map(Number);
    const [x, y] = this.ranges(width, height), at = frameOf(panel, x, y, width, height);
    const line = (d, colour) => `<path d="${d}" stroke="${colours[colour]}"/>`;
    const text = (left, top, content, anchor) => `<text x="${px(left)}" y="${px(top)}" text-anchor="${anchor}">${escapeXml(content)}</text>`;
    let ground = spans(panel, at).map(([ink, l, r]) => `<path d="M${px(l)} 0H${px(r)}V${height}H${px(l)}Z" fill="${colours[ink]}"/>`).join(""), marks = "";
    for (const [tick, label] of this.ticks(1, y)) {
      const top = px(at.y(tick));
      ground += line(`M0 ${top}H${width}`, "grid");
      marks += line(`M-4 ${top}H0`, "soft") + text(-8, top + 4.5, label, "end");
    }
    if (!panel.x.names.length) for (const [tick, label] of this.ticks(0, x)) {
      const left = px(at.x(tick));
      ground += line(`M${left} 0V${height}`, "grid");
      marks += line(`M${left} ${height}v4`, "soft") + text(left, height + 17, label, "middle");
    }
    view.querySelector(".ground").innerHTML = ground;
    view.querySelector(".ticks").innerHTML = marks;
    const map = view.querySelector(".map"), of = map && mapMarks(at);
    if (map) map.innerHTML = `<path d="${of.d}" fill="none" stroke="${colours.soft}" stroke-width="1.5"/>` + of.texts.map(([x, y, label]) => text(x, y, label, "middle")).join("");
    view.querySelector(".curves").innerHTML = panel.series.filter(s => !s.hidden).flatMap(s => shapes(panel, s, at)).map(s => svgPath(s, colours)).join("");
    for (const key of view.querySelectorAll("[data-series]")) if (panel.series[key.dataset.series].hidden) key.remove();
    return view;
  }

  // Puts on paper what is seen.
  print(view = this.onPaper()) {
    this.paper.replaceWith(view);
    this.paper = view;
  }

  // The point of a series nearest to the cursor: along x, or on a map anywhere.
  nearest(series, left, top, at) {
    const { x, y } = series, column = y[series.style === "boxes" ? 2 : 0];
    if (!x.length) return -1;
    if (!this.panel.scale && series.sorted) {
      const i = nearestIndex(x, this.u.posToVal(left, "x"));
      return Math.abs(at.x(x[i]) - left) < 40 || x.length > 1 && left > at.x(x[0]) && left < at.x(x[x.length - 1]) ? i : -1;
    }
    let best = -1, least = 30 * 30;
    for (let i = 0; i < x.length; i++) {
      if (x[i] == null || column[i] == null) continue;
      const d = (at.x(x[i]) - left) ** 2 + (at.y(column[i]) - top) ** 2;
      if (d < least) { least = d; best = i; }
    }
    return best;
  }

  // The names below the axis of x as they have room.
  names(u) {
    const { min, max } = u.scales.x;
    return nameLabels(this.panel.x.names, (u.bbox.width / devicePixelRatio || u.width - 80) / (max - min) - 8);
  }

  // Ticks of an axis over a range with their labels, in the steps of the screen.
  ticks(i, [min, max]) {
    const { u } = this, axis = u.axes[i], ticks = axis._found[1] ? axis.splits(u, i, min, max, ...axis._found) : [];
    const labels = axis.values(u, ticks);
    return ticks.map((tick, k) => [tick, labels[k]]);
  }

  // The cursor moved here: what is over the same time shows that too.
  pointed() {
    const { left, top } = this.u.cursor;
    const found = this.readout();
    if (this.linked) share(this, { time: !(left >= 0) ? null : this.panel.scale ? found : this.u.posToVal(left, "x") + this.panel.clock });
  }

  // Shows a time of the log, as if the cursor were there; null takes it away.
  showTime(time) {
    const { u, panel } = this;
    if (panel.scale) return this.readout(time);
    const left = time === null ? -10 : u.valToPos(time - panel.clock, "x");
    u.setCursor({ left: left >= 0 && left <= this.inner().width ? left : -10, top: -10 }, false);
    this.readout();
  }

  // The point of a series on a map at a time, if it was anywhere then.
  placeAt({ t, apart }, time) {
    if (!t || time === null) return -1;
    const i = nearestIndex(t, time - this.panel.clock);
    return Math.abs(t[i] - (time - this.panel.clock)) <= apart ? i : -1;
  }

  // Values under the cursor, or at a time on a map; returns the time of the place shown on a map.
  readout(time) {
    const { panel, u } = this, { left, top } = u.cursor, off = time === undefined ? !(left >= 0) : time === null, at = this.frame();
    let found = null, least = Infinity;
    const value = v => pretty(v, 5);
    panel.series.forEach((series, s) => {
      const i = off || series.hidden ? -1 : time !== undefined ? this.placeAt(series, time) : this.nearest(series, left, top, at);
      if (i >= 0 && series.t) {
        const far = time === undefined ? Math.hypot(at.x(series.x[i]) - left, at.y(series.y[0][i]) - top) : 0;
        if (far < least) { least = far; found = series.t[i] + panel.clock; }
      }
      const levels = i < 0 ? [] : series.y.map(column => column[i]);
      const main = levels[levels.length === 5 ? 2 : 0];
      const output = this.outputs[s], mark = this.marks[s];
      if (output) {
        output.textContent = i < 0 ? "" : panel.scale ? value(series.x[i]) + ", " + value(main)
          : levels.length === 2 ? value(levels[0]) + " … " + value(levels[1])
          : levels.length === 5 ? value(main) + " (" + value(levels[1]) + " … " + value(levels[3]) + ")"
          : value(main);
      }
      if (!mark) return;
      const dot = i >= 0 && levels.length === 1 && series.style !== "bars" && usable(main, panel.y.log) && usable(series.x[i], panel.x.log);
      const l = dot ? at.x(series.x[i]) : -1, t = dot ? at.y(main) : -1;
      mark.hidden = !(l >= 0 && l <= at.width && t >= 0 && t <= at.height);
      mark.style.transform = mark.hidden ? "" : `translate(${l}px, ${t}px)`;
    });
    if (panel.scale) {
      this.where.textContent = off || found === null ? "" : "time [s] " + value(found - panel.clock);
      return found;
    }
    const x = off ? null : u.posToVal(left, "x");
    this.where.textContent = off ? "" : panel.x.names.length ? panel.x.names[Math.round(x)] || "" : (panel.x.label || "x") + " " + value(x);
  }
}

// Shaded spans, each with its ink, in pixels.
function spans(panel, at) {
  const side = v => Math.max(0, Math.min(at.width, usable(v, at.logX) ? at.x(v) : NaN));
  const inked = (ink, spans) => spans.map(([from, to]) => [ink, side(from), side(to)]);
  return [...inked("shade", panel.shades), ...inked("alarm", panel.alarms)].filter(([, l, r]) => r > l);
}

function make(tag, className = "", text = "") {
  const element = document.createElement(tag);
  if (className) element.className = className;
  if (text) element.textContent = text;
  return element;
}
