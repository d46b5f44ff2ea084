// Where on the time line one is: moved by buttons, slider, keys, or time that passes.

import { button, byId, clamp, clock, setText } from "./dom.js";

const SPEEDS = [1, 5, 20, 60]; // s of the mission in a second
const LONGEST = 0.2; // s that pass between two frames at most, so that a tab that slept does not leap

export class Playback {
  /** From `begin` to `end`, in s. `live`: the end moves on, and who is there stays there. `changed()`: draw again, please. */
  constructor({ live, changed }) {
    this.begin = 0;
    this.end = 0;
    this.playing = live;
    this.speed = live ? 1 : 20;
    this._live = live;
    this._time = live ? Infinity : 0;
    this._changed = changed;
    this._last = 0;
    this._build();
    this._listen();
  }

  /** Whether what is shown is what is happening. */
  get following() {
    return this._live && this._time === Infinity;
  }

  get time() {
    return clamp(this._time, this.begin, this.end);
  }

  extend(begin, end) {
    Object.assign(this, { begin, end });
  }

  /** Let time pass up to `now` in ms and show where one is. Whether it has to be called again soon. */
  step(now) {
    if (this.playing && !this.following) {
      this._time = this.time + clamp((now - this._last) / 1000, 0, LONGEST) * this.speed;
      if (this._time >= this.end) this._arrive();
    }
    this._last = now;
    this._show();
    return this.playing && !this.following;
  }

  seek(time) {
    this._time = clamp(time, this.begin, this.end);
    if (this._live && time >= this.end) this.follow();
    this._changed();
  }

  /** To the end, and on with it. */
  follow() {
    this._time = Infinity;
    this.setPlaying(true);
  }

  setPlaying(playing) {
    if (!playing && this.following) this._time = this.end;
    if (playing && !this._live && this._time >= this.end) this._time = this.begin;
    this.playing = playing;
    this._last = performance.now();
    this._changed();
  }

  _arrive() {
    if (this._live) this.follow(); else this.setPlaying(false);
  }

  _show() {
    const slider = byId("slider");
    Object.assign(slider, { min: this.begin, max: Math.max(this.end, this.begin + 1) });
    slider.value = this.time;
    setText(byId("play"), this.playing ? (this._live ? "❚❚ Freeze" : "❚❚ Pause") : "▶ Play");
    byId("live").setAttribute("aria-pressed", String(this.following));
    setText(byId("clock"), `${clock(this.time - this.begin)} / ${clock(this.end - this.begin)}`);
    for (const one of byId("speeds").children) one.setAttribute("aria-pressed", String(Number(one.value) === this.speed));
  }

  _setSpeed(speed) {
    this.speed = speed;
    this._changed();
  }

  _build() {
    for (const speed of SPEEDS) {
      byId("speeds").append(Object.assign(button(`${speed}×`, "", () => this._setSpeed(speed)), { value: speed }));
    }
    byId("live").hidden = !this._live;
    if (this._live) byId("play").title = "Freeze what is shown, or let it go on (space); robots do not stop by it";
    byId("live").addEventListener("click", () => this.follow());
    byId("play").addEventListener("click", () => this.setPlaying(!this.playing));
    byId("slider").addEventListener("input", (event) => this.seek(Number(event.target.value)));
  }

  /** Keys that move on the time line; `more`: {key: what else it does}. */
  keys(more) {
    const faster = (by) => this._setSpeed(SPEEDS[clamp(SPEEDS.indexOf(this.speed) + by, 0, SPEEDS.length - 1)]);
    this._keys = {
      " ": () => this.setPlaying(!this.playing),
      ArrowLeft: (event) => this.seek(this.time - (event.shiftKey ? 30 : 5)),
      ArrowRight: (event) => this.seek(this.time + (event.shiftKey ? 30 : 5)),
      ArrowUp: () => faster(1), ArrowDown: () => faster(-1),
      Home: () => this.seek(this.begin), End: () => this.seek(this.end),
      ...more,
    };
  }

  _listen() {
    this.keys({});
    document.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "SELECT" || event.target.type === "number") return;
      // Buttons, boxes and summaries keep what space means to them.
      if (event.key === " " && (["BUTTON", "SUMMARY"].includes(event.target.tagName) || event.target.type === "checkbox")) return;
      if (!this._keys[event.key]) return;
      event.preventDefault();
      this._keys[event.key](event);
    });
  }
}
