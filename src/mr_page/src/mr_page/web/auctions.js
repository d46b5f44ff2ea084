// The auctions of a team, the newest first: each a line that unfolds into all bids, those that lost, too.

import { clock, fixed, make } from "./dom.js";
import { swatch, table } from "./elements.js";

export const MOST = 50; // auctions that are listed

const HINT = "Bold: the bid of who explores it; the lowest may lose, as all are weighed together. Rings on the map: clusters, and who explores them.";

/**
 * A list of auctions {key, robot (auctioneer), at (s), unit, offers: [[x, y, {robot: bid}, explored by], ...], note, state}:
 * `note` in place of who won what where nobody has yet; another `state` (undefined: it does not change) is told anew.
 */
export class AuctionHistory {
  /** `frame`: of the places, in words. `changed()`: another auction is pointed at, please show it on the map. */
  constructor(element, theme, frame, changed) {
    this._list = make("div", undefined, "auctions");
    this._none = make("p", "No auction has been held yet.", "hint");
    this._hint = make("p", `${HINT} Places: m, ${frame}.`, "hint");
    element.append(this._list, this._none, this._hint);
    this._theme = theme;
    this._changed = changed;
    this._look = "";
    this._rows = new Map(); // by key: {auction, element}
    this._unfolded = new Set(); // keys, the last one last
    this._hovered = null;
  }

  /** The one that is pointed at or was unfolded last; null: none. */
  get pointedAt() {
    const last = [...this._unfolded].findLast((key) => this._rows.has(key));
    return (this._rows.get(this._hovered) ?? this._rows.get(last))?.auction ?? null;
  }

  /** `auctions`: at most MOST, the newest first; `begin`: their clock is zero then, s; `names`: of all robots. */
  fill(auctions, begin, names) {
    const look = JSON.stringify([this._theme.dark, begin, names]), wanted = new Map(auctions.map((one) => [one.key, one.state]));
    for (const [key, { auction, element }] of this._rows) {
      if (look === this._look && wanted.has(key) && wanted.get(key) === auction.state) continue;
      element.remove();
      this._rows.delete(key);
    }
    this._look = look;
    auctions.forEach((auction, i) => {
      if (!this._rows.has(auction.key)) this._rows.set(auction.key, { auction, element: this._row(auction, begin, names) });
      const { element } = this._rows.get(auction.key), there = this._list.children[i];
      if (there !== element) this._list.insertBefore(element, there ?? null);
    });
    this._none.hidden = auctions.length > 0;
    this._hint.hidden = !auctions.length;
  }

  _row(auction, begin, names) {
    const box = make("details"), head = make("summary"), { key } = auction;
    const paint = (name) => swatch(this._theme, names.indexOf(name));
    head.append(make("time", clock(auction.at - begin)), paint(auction.robot), make("b", auction.robot), ": ", ...outcome(auction, paint));
    box.append(head);
    const unfold = () => { if (box.open && !box.children[1]) box.append(bidTable(auction, paint, names)); };
    box.open = this._unfolded.has(key);
    unfold();
    box.addEventListener("toggle", () => {
      unfold();
      if (box.open !== this._unfolded.has(key)) this._remember(key, box.open);
    });
    box.addEventListener("pointerenter", () => this._point(key));
    box.addEventListener("pointerleave", () => this._point(null));
    return box;
  }

  _remember(key, open) {
    this._unfolded.delete(key);
    if (open) this._unfolded.add(key);
    if (this._unfolded.size > MOST) this._unfolded.delete(this._unfolded.values().next().value);
    this._changed();
  }

  _point(key) {
    this._hovered = key;
    this._changed();
  }
}

/** Who explores what, at what bid: what the auctioneer took first. */
function outcome({ robot, unit, offers, note }, paint) {
  if (note) return [make("span", note, "hint")];
  const own = offers.filter(([, , , by]) => by === robot), won = offers.filter(([, , , by]) => by && by !== robot);
  const parts = [...own, ...won].map(([x, y, bids, by]) => {
    const part = make("span", undefined, "won"), bid = bids[by] === undefined ? "" : ` at ${bidText(bids[by], unit)}`;
    part.append(paint(by), `${by} ${placeText(x, y)}${bid}`);
    return part;
  });
  const left = offers.length - parts.length;
  if (left) parts.push(make("span", `${left} of ${offers.length} to nobody yet`, "hint"));
  return parts.flatMap((part, i) => (i ? [" · ", part] : [part]));
}

/** A row for each cluster, a column for each robot that has bid or explores one: first the auctioneer. */
function bidTable({ robot, unit, offers }, paint, names) {
  const others = new Set(offers.flatMap(([, , bids, by]) => [...Object.keys(bids), by]));
  const bidders = [robot, ...[...others].filter((name) => name && name !== robot).sort((a, b) => names.indexOf(a) - names.indexOf(b))];
  const heads = bidders.map((name) => {
    const head = make("span");
    head.append(paint(name), name.replace(/^robot_/, ""));
    head.title = name;
    return head;
  });
  const rows = offers.map(([x, y, bids, by]) => {
    const place = make("span");
    place.append(paint(by), placeText(x, y));
    if (!by) place.firstChild.style.background = "none";
    place.title = by ? `explored by ${by}` : "explored by nobody yet";
    return [place, ...bidders.map((name) => make(name === by ? "b" : "span", name in bids ? bidText(bids[name], unit) : "–"))];
  });
  const box = make("div", undefined, "bids");
  box.append(offers.length ? table(["Cluster", ...heads], rows) : make("p", "No bids are known.", "hint"));
  return box;
}

const placeText = (x, y) => `(${fixed(x, 1)}, ${fixed(y, 1)})`;

/** `unit`: 1 for m², else the number of the strategy whose bids they are. */
export function bidText(bid, unit) {
  return `${bid === null ? "∞" : fixed(bid, 1)}${unit === 1 ? " m²" : ""}`;
}
