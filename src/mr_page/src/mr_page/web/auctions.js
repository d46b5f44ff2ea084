// The last auctions of robots with all bids, those that lost, too.

import { fixed, make } from "./dom.js";
import { Filled, swatch } from "./elements.js";

const HINT = "Bold: the bid of who explores it. The lowest bid may lose: all are weighed together.";

export class LastAuctions {
  constructor(element, theme) {
    this._filled = new Filled(element);
    this._unfolded = new Map(); // by robot, what somebody has unfolded or folded
    this._theme = theme;
  }

  /** `held`: [robot, {offers: [[x, y, {robot: bid}, explored by], ...], unit}]; `number(robot)` tells its colour. */
  fill(held, number) {
    this._filled.fill([this._theme.dark, held], () => [
      ...held.map(([name, auction]) => this._auction(number, name, auction, held.length === 1)),
      ...(held.length ? [make("p", HINT, "hint")] : []),
    ]);
  }

  /** The last auction that a robot has held, folded to one line where there are several robots. */
  _auction(number, name, { offers, unit }, alone) {
    const box = make("details"), head = make("summary"), list = make("ul", undefined, "list");
    const own = offers.find(([, , , by]) => by === name), count = `${offers.length} cluster${offers.length === 1 ? "" : "s"}`;
    const got = own ? `it took (${fixed(own[0], 1)}, ${fixed(own[1], 1)})` : "none was for it";
    head.append(swatch(this._theme, number(name)), `Last auction of ${name}: ${count}, ${got}`);
    for (const [x, y, bids, by] of offers) {
      const item = make("li"), text = make("div");
      text.append(`(${fixed(x, 1)}, ${fixed(y, 1)}): ${by ? `explored by ${by}` : "explored by nobody yet"}`, bidLine(bids, unit, by));
      item.append(swatch(this._theme, number(by)), text);
      if (!by) item.firstChild.style.background = "none";
      list.append(item);
    }
    box.open = this._unfolded.get(name) ?? alone;
    head.addEventListener("click", () => this._unfolded.set(name, !box.open));
    box.append(head, list);
    return box;
  }
}

/** Bids in small print, that of the robot `winner` in bold. */
export function bidLine(bids, unit, winner) {
  const line = make("div", "bids: ", "hint");
  Object.entries(bids).forEach(([name, bid], i) => {
    const told = `${name} ${bid === null ? "∞" : fixed(bid, 1)}${unit === 1 ? " m²" : ""}`;
    line.append(i ? " · " : "", name === winner ? make("b", told) : told);
  });
  return line;
}
