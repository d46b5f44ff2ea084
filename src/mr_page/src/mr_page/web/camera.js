// Which part of the world a canvas shows.

import { clamp } from "./dom.js";

export class Camera {
  /** `changed()` is called when somebody moves it. */
  constructor(canvas, changed) {
    this.canvas = canvas;
    this.x = 0;
    this.y = 0;
    this.scale = 1; // pixels of the style sheet per metre
    this.fitted = true; // shows everything, also when more comes
    this._changed = changed;
    this._pointers = new Map();
    this._listen();
  }

  get key() {
    return `${this.x} ${this.y} ${this.scale} ${this.canvas.width} ${this.canvas.height}`;
  }

  /** Show the box [left, bottom, right, top] in m. */
  fit([left, bottom, right, top]) {
    const { clientWidth, clientHeight } = this.canvas;
    const scale = Math.min(clientWidth / Math.max(right - left, 0.1), clientHeight / Math.max(top - bottom, 0.1));
    Object.assign(this, { x: (left + right) / 2, y: (bottom + top) / 2, scale: Math.max(scale, 0.01) });
  }

  showAll() {
    this.fitted = true;
    this._changed();
  }

  zoom(factor, px = this.canvas.clientWidth / 2, py = this.canvas.clientHeight / 2) {
    const [x, y] = this.toWorld(px, py);
    this.scale = clamp(this.scale * factor, 0.5, 2000);
    this.x = x - (px - this.canvas.clientWidth / 2) / this.scale;
    this.y = y + (py - this.canvas.clientHeight / 2) / this.scale;
    this.fitted = false;
    this._changed();
  }

  move(dx, dy) {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
    this.fitted = false;
    this._changed();
  }

  toScreen(x, y) {
    const { clientWidth, clientHeight } = this.canvas;
    return [clientWidth / 2 + (x - this.x) * this.scale, clientHeight / 2 - (y - this.y) * this.scale];
  }

  toWorld(px, py) {
    const { clientWidth, clientHeight } = this.canvas;
    return [this.x + (px - clientWidth / 2) / this.scale, this.y - (py - clientHeight / 2) / this.scale];
  }

  _listen() {
    const { canvas } = this, drop = (event) => this._pointers.delete(event.pointerId);
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.0015), event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      this._pointers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointerup", drop);
    canvas.addEventListener("pointercancel", drop);
    canvas.addEventListener("pointermove", (event) => this._drag(event));
    canvas.addEventListener("dblclick", () => this.showAll());
  }

  /** One pointer moves, two zoom as well. */
  _drag(event) {
    const before = this._pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY], others = [...this._pointers].filter(([id]) => id !== event.pointerId);
    this._pointers.set(event.pointerId, now);
    this.move((now[0] - before[0]) / (others.length + 1), (now[1] - before[1]) / (others.length + 1));
    if (!others.length) return;
    const box = this.canvas.getBoundingClientRect(), [x, y] = others[0][1];
    const distance = (point) => Math.max(10, Math.hypot(point[0] - x, point[1] - y));
    this.zoom(distance(now) / distance(before), (now[0] + x) / 2 - box.left, (now[1] + y) / 2 - box.top);
  }
}
