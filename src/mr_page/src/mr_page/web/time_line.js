// What happened when, from left to right.

import { byId, clamp, clock } from "./dom.js";
import { line, sized } from "./drawing.js";

const PAD = 8; // px: half of a slider's thumb
const QUIET = new Set(["warning", "error", "fatal"]); // there may be hundreds; they are in the list

/** Events are {at, robot (number), kind, text}; `span` is {begin, end, now} in s; `auctions`: times for each robot. */
export class TimeLine {
  /** `seek(time)` is called where there is something to go back to. */
  constructor(theme, seek) {
    this._theme = theme;
    this._canvas = byId("marks");
    this._seek = seek;
    this._span = { begin: 0, end: 1, now: 0 };
    this._events = [];
    this._listen();
  }

  draw(span, events, auctions) {
    Object.assign(this, { _span: span, _events: events });
    const { context, width, height } = sized(this._canvas);
    auctions.forEach((times, index) => {
      context.globalAlpha = 0.5;
      for (const time of times) {
        const x = this._x(time, width);
        line(context, [x, height - 7], [x, height], this._theme.colour(index), 1);
      }
      context.globalAlpha = 1;
    });
    for (const event of events) if (!QUIET.has(event.kind)) this._mark(context, event, this._x(event.at, width));
    const now = this._x(span.now, width);
    line(context, [now, 0], [now, height], this._theme.css.accent, 1.5);
  }

  _x(time, width) {
    const { begin, end } = this._span;
    return PAD + (width - 2 * PAD) * clamp((time - begin) / (end - begin || 1), 0, 1);
  }

  _time(x) {
    const { begin, end } = this._span;
    return begin + clamp((x - PAD) / (this._canvas.clientWidth - 2 * PAD), 0, 1) * (end - begin);
  }

  _mark(context, { kind, robot }, x) {
    const colour = this._theme.colour(robot);
    if (kind === "finished" || kind === "joined") {
      line(context, [x, 2], [x, 20], colour, 1.5);
      context.fillStyle = colour;
      context.fillRect(kind === "joined" ? x - 8 : x, 2, 8, 6);
    } else if (kind === "died") {
      line(context, [x, 2], [x, 20], colour, 2.5);
      line(context, [x - 4, 7], [x + 4, 7], colour, 2.5);
    } else if (kind === "failed") {
      line(context, [x - 3, 13], [x + 3, 19], this._theme.css.warn, 1.5);
      line(context, [x - 3, 19], [x + 3, 13], this._theme.css.warn, 1.5);
    } else if (kind === "link" || kind in STAGES) {
      line(context, [x, 13], [x, 19], colour, kind === "link" ? 1 : 2.5);
    } else {
      diamond(context, x, kind === "command" ? this._theme.css.accent : this._theme.mergeColour(kind));
    }
  }

  _listen() {
    const canvas = this._canvas, tip = byId("tip");
    if (this._seek) {
      canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        this._seek(this._time(event.offsetX));
      });
    }
    canvas.addEventListener("pointermove", (event) => {
      if (this._seek && event.buttons) this._seek(this._time(event.offsetX));
      this._tell(event, tip);
    });
    canvas.addEventListener("pointerleave", () => { tip.hidden = true; });
  }

  _tell(event, tip) {
    const near = this._events.filter(
      (e) => !QUIET.has(e.kind) && Math.abs(this._x(e.at, this._canvas.clientWidth) - event.offsetX) < 6,
    ).slice(0, 4);
    tip.hidden = !near.length;
    tip.textContent = near.map((e) => `${clock(e.at - this._span.begin)} ${e.text}`).join(" · ");
    tip.style.left = `${clamp(event.clientX - 20, 4, Math.max(4, window.innerWidth - 350))}px`;
    tip.style.top = `${event.clientY - 44}px`;
  }
}

const STAGES = { starting: 0, exploring: 1, waiting: 2, returning: 3 };

function diamond(context, x, style) {
  context.beginPath();
  context.moveTo(x, 1);
  context.lineTo(x + 5, 6);
  context.lineTo(x, 11);
  context.lineTo(x - 5, 6);
  context.closePath();
  context.fillStyle = style;
  context.fill();
}
