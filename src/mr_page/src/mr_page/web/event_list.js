// What happened, in words.

import { byId, clock, make } from "./dom.js";

export class EventList {
  /** At most `most` lines, then the oldest go. `picked(event)` when somebody clicks a line. */
  constructor(most, picked) {
    this._most = most;
    this._list = byId("events");
    this._picked = picked;
    this._items = [];
    this._now = -2;
  }

  /** Events {at, kind, text} that are new, with times from `begin` on; whoever looks at the end stays there. */
  add(events, begin) {
    if (!events.length) return;
    const list = this._list, following = list.scrollHeight - list.scrollTop - list.clientHeight < 30;
    for (const event of events.slice(-this._most)) {
      const item = make("li");
      item.append(make("time", clock(event.at - begin)), make("span", event.text, event.kind));
      if (this._picked) item.addEventListener("click", () => this._picked(event));
      this._items.push(item);
      list.append(item);
    }
    while (this._items.length > this._most) this._items.shift().remove();
    if (following) list.scrollTop = list.scrollHeight;
  }

  clear() {
    for (const item of this._items) item.remove();
    this._items = [];
  }

  /** Number `now` is the last event that has happened; later ones are pale. */
  mark(now) {
    if (now === this._now) return;
    this._now = now;
    this._items.forEach((item, i) => { item.className = i > now ? "later" : i === now ? "now" : ""; });
    const list = this._list, item = this._items[Math.max(0, now)];
    if (item) list.scrollTop = item.offsetTop - list.offsetTop - list.clientHeight / 2;
  }
}
