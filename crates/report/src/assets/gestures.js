// What hands do with a plot: wheel, mouse, fingers, keys.
"use strict";

class Gestures {
  // Where an event is, in shares of the plot from its lower left.
  placeOf({ clientX, clientY }) {
    const box = this.u.over.getBoundingClientRect();
    return [(clientX - box.left) / box.width, 1 - (clientY - box.top) / box.height];
  }

  // The wheel zooms with Ctrl, or alone where the plot has the focus: else it scrolls the page. Dragging with Shift or the
  // middle button moves what is zoomed.
  bindWheel() {
    const { u } = this, { over } = u;
    over.addEventListener("wheel", event => {
      const { deltaX, deltaY, deltaMode, ctrlKey, metaKey, shiftKey } = event;
      if (!ctrlKey && !metaKey && document.activeElement !== u.root) return;
      event.preventDefault();
      const pixels = v => Math.max(-200, Math.min(200, v * (deltaMode ? 30 : 1)));
      if (shiftKey || Math.abs(deltaX) > Math.abs(deltaY)) this.change(1, undefined, [pixels(deltaX || deltaY) / over.clientWidth, 0]);
      else this.change(Math.exp(pixels(deltaY) / 400), this.placeOf(event));
    }, { passive: false });
    over.addEventListener("mousedown", event => {
      if (event.button !== 1 && !(event.button === 0 && event.shiftKey)) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      u.root.focus({ preventScroll: true });
      let last = this.placeOf(event);
      const moved = event => {
        const here = this.placeOf(event);
        this.change(1, undefined, [last[0] - here[0], last[1] - here[1]]);
        last = here;
      };
      addEventListener("mousemove", moved);
      addEventListener("mouseup", () => removeEventListener("mousemove", moved), { once: true });
    }, true);
  }

  // A finger that moves sideways selects as the mouse does; up and down it scrolls the page. Two zoom and move.
  bindTouch() {
    const { u } = this, { over } = u;
    let from = null;
    const fingers = new Map();
    const pinch = event => {
      const seen = () => {
        const [[ax, ay], [bx, by]] = fingers.values();
        return { middle: [(ax + bx) / 2, (ay + by) / 2], apart: this.panel.scale ? Math.hypot(ax - bx, ay - by) : Math.abs(ax - bx) };
      };
      const before = seen();
      fingers.set(event.pointerId, this.placeOf(event));
      const { middle, apart } = seen(), factor = Math.max(0.5, Math.min(2, Math.max(before.apart, 0.02) / Math.max(apart, 0.02)));
      this.change(factor, before.middle, before.middle.map((v, i) => (v - middle[i]) * factor));
    };
    const select = event => {
      const box = over.getBoundingClientRect(), within = (v, n) => Math.max(0, Math.min(n, v));
      const at = within(event.clientX - box.left, box.width), left = Math.min(from.x, at), width = Math.abs(at - from.x);
      const height = this.panel.scale ? width * box.height / box.width : box.height;
      const top = this.panel.scale ? within(from.y - height / 2, box.height - height) : 0;
      u.setSelect({ left, top, width, height }, false);
    };
    over.addEventListener("pointerdown", event => {
      if (event.pointerType === "touch") fingers.set(event.pointerId, this.placeOf(event));
      if (event.pointerType !== "touch" || !event.isPrimary) {
        from = null;
        u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        return;
      }
      const box = over.getBoundingClientRect();
      from = { x: event.clientX - box.left, y: event.clientY - box.top };
    });
    over.addEventListener("pointermove", event => {
      if (fingers.size === 2 && fingers.has(event.pointerId)) pinch(event);
      else if (from && event.isPrimary) select(event);
    });
    const end = take => event => {
      fingers.delete(event.pointerId);
      if (!from || !event.isPrimary) return;
      from = null;
      if (take && u.select.width >= 12) this.selected(u);
      else u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    };
    over.addEventListener("pointerup", end(true));
    over.addEventListener("pointercancel", end(false));
  }

  // Plus and minus zoom, arrows move what is zoomed, with Shift the cursor; 0 and Escape show all again.
  bindKeys() {
    const { u, panel } = this;
    const keys = {
      "+": () => this.change(0.5), "=": () => this.change(0.5), "-": () => this.change(2), 0: () => this.setZoom(null), Escape: () => this.setZoom(null),
      ArrowLeft: () => this.change(1, undefined, [-0.25, 0]), ArrowRight: () => this.change(1, undefined, [0.25, 0]),
    };
    if (panel.scale) Object.assign(keys, { ArrowUp: () => this.change(1, undefined, [0, 0.25]), ArrowDown: () => this.change(1, undefined, [0, -0.25]) });
    const step = { ArrowLeft: -0.01, ArrowRight: 0.01 };
    u.root.tabIndex = 0;
    u.root.addEventListener("keydown", event => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const key = event.shiftKey && step[event.key] ? () => this.stepCursor(step[event.key]) : keys[event.key];
      if (!key) return;
      if (event.key !== "Escape") event.preventDefault();
      key();
    });
  }

  // Moves the cursor by a share of the plot, from its middle without a cursor.
  stepCursor(by) {
    const { u } = this, { width, height } = this.inner();
    const left = u.cursor.left >= 0 ? u.cursor.left : width / 2;
    u.setCursor({ left: Math.max(0, Math.min(width, left + by * width)), top: height / 2 });
  }
}
