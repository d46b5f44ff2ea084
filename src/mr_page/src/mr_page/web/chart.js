// A value over time, of the team and of each robot.

import { clamp, clock } from "./dom.js";
import { disc, line, sized } from "./drawing.js";

const BOX = { left: 42, right: 20, top: 8, bottom: 22 };
const STEPS = [5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200]; // s between two marks of the axis

/** Lines are {time: [], value: [] (null: not known), colour, width}. */
export class Chart {
  constructor(canvas, theme, unit, seek) {
    this._canvas = canvas;
    this._theme = theme;
    this._unit = unit;
    this._picture = null;
    this._span = { begin: 0, end: 1 };
    this._top = 1;
    if (seek) this._listen(seek);
  }

  /** Everything that does not move with the time shown; `ticks`: [{at, colour}] on the axis. */
  paint(span, lines, ticks = []) {
    const ratio = window.devicePixelRatio || 1, { clientWidth: width, clientHeight: height } = this._canvas;
    const highest = Math.max(1, ...lines.map((one) => one.value.reduce((most, v) => Math.max(most, v ?? 0), 0)));
    Object.assign(this, { _span: span, _top: 1.06 * highest });
    this._picture = document.createElement("canvas");
    Object.assign(this._picture, { width: Math.max(1, width * ratio), height: Math.max(1, height * ratio) });
    const context = this._picture.getContext("2d");
    context.scale(ratio, ratio);
    this._axes(context, width, height);
    for (const one of lines) this._line(context, one, width, height);
    for (const { at, colour } of ticks) {
      const x = this._x(at, width);
      line(context, [x, height - BOX.bottom], [x, height - BOX.bottom - 5], colour, 2);
    }
  }

  /** The picture with a mark at `now` and a dot {value, colour, radius} for each line. */
  draw(now, dots) {
    const { context, width, height } = sized(this._canvas);
    if (this._picture) context.drawImage(this._picture, 0, 0, width, height);
    const x = this._x(now, width);
    line(context, [x, BOX.top], [x, height - BOX.bottom], this._theme.css.accent, 1.5);
    for (const { value, colour, radius } of dots) {
      if (value !== null && value !== undefined) disc(context, x, this._y(value, height), radius, colour);
    }
  }

  _x(time, width) {
    const { begin, end } = this._span;
    return BOX.left + (width - BOX.left - BOX.right) * ((time - begin) / (end - begin || 1));
  }

  _y(value, height) {
    return height - BOX.bottom - (height - BOX.top - BOX.bottom) * (value / this._top);
  }

  _axes(context, width, height) {
    const { css } = this._theme, { begin, end } = this._span, step = niceStep(this._top, 4);
    context.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    context.fillStyle = css.soft;
    context.textAlign = "right";
    for (let value = 0; value <= this._top; value += step) {
      const y = this._y(value, height);
      line(context, [BOX.left, y], [width - BOX.right, y], css.line, 1);
      context.fillText(`${Math.round(value * 10) / 10}`, BOX.left - 5, y + 4);
    }
    context.textAlign = "center";
    const pause = STEPS.find((s) => (end - begin) / s <= 6) ?? 14400;
    for (let time = 0; time <= end - begin + 1e-6; time += pause) {
      context.fillText(clock(time), this._x(begin + time, width), height - 6);
    }
    context.textAlign = "left";
    context.fillText(this._unit, 2, BOX.top + 4);
  }

  _line(context, { time, value, colour, width: lineWidth }, width, height) {
    context.beginPath();
    time.forEach((at, i) => {
      if (value[i] !== null) context.lineTo(this._x(at, width), this._y(value[i], height));
    });
    context.strokeStyle = colour;
    context.lineWidth = lineWidth;
    context.lineJoin = "round";
    context.stroke();
  }

  _listen(seek) {
    const canvas = this._canvas, go = (x) => {
      const share = clamp((x - BOX.left) / (canvas.clientWidth - BOX.left - BOX.right), 0, 1);
      seek(this._span.begin + share * (this._span.end - this._span.begin));
    };
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); go(event.offsetX); });
    canvas.addEventListener("pointermove", (event) => { if (event.buttons) go(event.offsetX); });
  }
}

function niceStep(span, count) {
  const raw = span / count, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((m) => m * power >= raw);
}
