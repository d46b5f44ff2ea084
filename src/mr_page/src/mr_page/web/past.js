// What a running team has told before, as far as the server keeps it.

import { Live } from "./live.js";

export class Past {
  /** `ask(time)` has the server tell what was at that time. It is asked again when it has answered. */
  constructor(theme, ask) {
    this.team = new Live(theme);
    this._ask = ask;
    this.reset();
  }

  /** What was asked for does not come any more. */
  reset() {
    this.known = false; // whether `team` is that of some moment
    this._asked = false;
    this._span = null; // [from, to] of the times that `team` was like this
  }

  /** The time that is looked at; the team of that time comes later. */
  lookAt(time) {
    const [from, to] = this._span ?? [Infinity, -Infinity];
    if (this._asked || (from <= time && time <= to)) return;
    this._asked = true;
    this._ask(time);
  }

  /** Other maps are looked at. */
  askAgain() {
    this._span = null;
  }

  take(update) {
    const [from, to] = update.moment;
    this._asked = false;
    this._span = [from ?? -Infinity, to];
    if (update.anew.length) {
      this.team.become(update);
      this.known = true;
    }
  }
}
