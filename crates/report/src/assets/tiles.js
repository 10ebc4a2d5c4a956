// The background of a map: tiles of OpenStreetMap, from when the reader asks for them.
"use strict";

const TILE_HOST = "tile.openstreetmap.org", TILE_SIZE = 256, MOST_TILES = 60, FINEST_ZOOM = 19;
// Farther from the origin [m] there is no background: the map's plane leaves the Earth.
const FARTHEST = 1e6;

// Between a map's east and north [m] and the unit square of Web Mercator, x eastwards and y southwards.
class Mercator {
  constructor({ lat_deg, lon_deg }) {
    this.lat = lat_deg * Math.PI / 180;
    this.origin = [lon_deg / 360 + 0.5, (1 - Math.asinh(Math.tan(this.lat)) / Math.PI) / 2];
    // A metre at the origin.
    this.metre = 1 / (2 * Math.PI * 6378137 * Math.cos(this.lat));
  }

  // Distance from the Earth's axis and from the equator's plane [m] of a latitude on the ellipsoid, WGS-84.
  static meridian(lat) {
    const eccentricitySq = 6.69437999014e-3, radius = 6378137 / Math.sqrt(1 - eccentricitySq * Math.sin(lat) ** 2);
    return [radius * Math.cos(lat), radius * (1 - eccentricitySq) * Math.sin(lat)];
  }

  // As the program places a track: in the plane that touches the ellipsoid at the origin.
  toMap([x, y]) {
    const lat = Math.atan(Math.sinh(Math.PI * (1 - 2 * y))), lon = 2 * Math.PI * (x - this.origin[0]);
    const [out, up] = Mercator.meridian(lat), [out0, up0] = Mercator.meridian(this.lat);
    return [out * Math.sin(lon), (up - up0) * Math.cos(this.lat) - (out * Math.cos(lon) - out0) * Math.sin(this.lat)];
  }

  fromMap([east, north]) {
    let [x, y] = this.origin;
    for (let round = 0; round < 12; round++) {
      const [e, n] = this.toMap([x, y]);
      x += (east - e) * this.metre;
      y -= (north - n) * this.metre;
    }
    return [x, y];
  }
}

// The CSS transform that brings the corners of a square, clockwise from the upper left, to given places: a projection.
function squareTo(size, [[x0, y0], [x1, y1], [x2, y2], [x3, y3]]) {
  const ax = x1 - x2, ay = y1 - y2, bx = x3 - x2, by = y3 - y2, sx = x0 - x1 + x2 - x3, sy = y0 - y1 + y2 - y3;
  const area = ax * by - bx * ay, g = (sx * by - bx * sy) / area, h = (ax * sy - sx * ay) / area;
  const across = [x1 - x0 + g * x1, y1 - y0 + g * y1, 0, g], down = [x3 - x0 + h * x3, y3 - y0 + h * y3, 0, h];
  return `matrix3d(${[...across.map(v => v / size), ...down.map(v => v / size), 0, 0, 1, 0, x0, y0, 0, 1]})`;
}

class Background {
  constructor(plot) {
    Object.assign(this, { plot, mercator: new Mercator(plot.panel.origin), tiles: new Map(), layer: make("div", "tiles"), credit: make("span", "credit") });
    const item = plot.legend.appendChild(make("li")), label = item.appendChild(make("label"));
    this.box = label.appendChild(make("input"));
    Object.assign(this.box, { type: "checkbox", autocomplete: "off", onchange: () => this.asked() });
    label.append(`Map background (asks ${TILE_HOST} for pictures of this area)`);
    this.note = item.appendChild(make("small"));
    this.note.setAttribute("role", "status");
    this.credit.innerHTML = `© <a href="https://www.openstreetmap.org/copyright">OpenStreetMap</a> contributors`;
  }

  asked() {
    this.note.textContent = "";
    // Its usage policy asks for a Referer, which a page opened as a file does not send.
    if (this.box.checked && location.protocol === "file:") {
      this.box.checked = false;
      this.note.textContent = `${TILE_HOST} refuses pages that are opened as files. Open the report from a web server, such as "python3 -m http.server" in its folder.`;
      return;
    }
    if (this.box.checked) {
      this.plot.u.under.append(this.layer);
      this.plot.box.append(this.credit);
      this.load();
      this.place();
    } else {
      clearTimeout(this.timer);
      this.layer.remove();
      this.credit.remove();
      this.layer.textContent = "";
      this.tiles.clear();
    }
  }

  // The view has changed: tiles follow at once, those that are missing are loaded when it is at rest.
  moved() {
    if (!this.box.checked) return;
    this.place();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.load(), 250);
  }

  place() {
    const { u } = this.plot, at = this.plot.frame(), { offsetLeft, offsetTop, offsetWidth, offsetHeight } = u.over;
    for (const { image, corners } of this.tiles.values()) image.style.transform = squareTo(TILE_SIZE, corners.map(([east, north]) => [at.x(east), at.y(north)]));
    this.credit.style.right = u.width - offsetLeft - offsetWidth + "px";
    this.credit.style.bottom = u.height - offsetTop - offsetHeight + "px";
  }

  // Zoom, column and row of the tiles in view.
  wanted() {
    const { x, y } = this.plot.u.scales, at = this.plot.frame();
    if (!([x.min, x.max, y.min, y.max].every(v => Math.abs(v) < FARTHEST))) return [];
    // Parallels are bent on the map: the middle of an edge counts too.
    const along = ({ min, max }) => [min, (min + max) / 2, max];
    const seen = along(x).flatMap(east => along(y).map(north => this.mercator.fromMap([east, north])));
    const tileAtZero = (at.x(1) - at.x(0)) / this.mercator.metre;
    for (let zoom = Math.max(0, Math.min(FINEST_ZOOM, Math.round(Math.log2(tileAtZero / TILE_SIZE)))); zoom >= 0; zoom--) {
      const count = 2 ** zoom, [columns, rows] = [0, 1].map(i => seen.map(place => Math.floor(place[i] * count)));
      const [west, east, top, bottom] = [Math.min(...columns), Math.max(...columns), Math.max(0, Math.min(...rows)), Math.min(count - 1, Math.max(...rows))];
      if ((east - west + 1) * (bottom - top + 1) > MOST_TILES) continue;
      const tiles = [];
      for (let row = top; row <= bottom; row++) for (let column = west; column <= east; column++) tiles.push([zoom, column, row]);
      return tiles;
    }
    return [];
  }

  async load() {
    const wanted = this.wanted(), names = new Set(wanted.map(String));
    this.names = names;
    for (const [zoom, column, row] of wanted) {
      const name = String([zoom, column, row]), count = 2 ** zoom;
      if (this.tiles.has(name)) continue;
      const corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([right, down]) => this.mercator.toMap([(column + right) / count, (row + down) / count]));
      const image = this.layer.appendChild(new Image(TILE_SIZE, TILE_SIZE));
      // The host receives the site that asks, whatever the page's own policy: its usage policy demands that.
      Object.assign(image, { alt: "", draggable: false, referrerPolicy: "strict-origin-when-cross-origin" });
      image.src = `https://${TILE_HOST}/${zoom}/${(column % count + count) % count}/${row}.png`;
      this.tiles.set(name, { image, corners });
    }
    this.place();
    // What was shown stays below until the new tiles are there.
    const drop = name => {
      this.tiles.get(name)?.image.remove();
      this.tiles.delete(name);
    };
    const loaded = await Promise.allSettled([...names].map(name => this.tiles.get(name).image.decode()));
    if (this.names !== names || !this.box.checked) return;
    const failed = [...names].filter((_, i) => loaded[i].status === "rejected");
    for (const name of this.tiles.keys()) if (!names.has(name)) drop(name);
    failed.forEach(drop);
    this.note.textContent = failed.length ? `${TILE_HOST} sent ${names.size - failed.length} of ${names.size} pictures.` : "";
  }
}
