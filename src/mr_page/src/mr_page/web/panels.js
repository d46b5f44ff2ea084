// The panels of a running team beside its map. Each has a title and fills itself when it is shown.

import { AuctionHistory, bidText } from "./auctions.js";
import { Chart } from "./chart.js";
import { byId, button, bytes, clock, fixed, kilobits, make, setText } from "./dom.js";
import { Filled, swatch, table } from "./elements.js";
import { EventList } from "./event_list.js";

/** Shows one panel at a time. */
export class Tabs {
  constructor(panels) {
    this._panels = panels;
    this._buttons = panels.map((panel, i) => button(panel.title, "", () => this.show(i)));
    this._buttons.forEach((one, i) => { one.setAttribute("role", "tab"); one.id = `tab-${panels[i].name}`; });
    byId("tabs").append(...this._buttons);
    byId("panels").append(...panels.map((panel) => panel.element));
    this.show(0);
  }

  show(number) {
    this._shown = number;
    this._panels.forEach((panel, i) => {
      panel.element.hidden = i !== number;
      this._buttons[i].setAttribute("aria-selected", String(i === number));
    });
    if (this._filled) this.fill(...this._filled);
    this._panels[number].shown?.();
  }

  /** `view`: number of the robot whose map is shown; `chosen`: of the one that somebody has chosen; TEAM: none. */
  fill(live, view, chosen) {
    this._filled = [live, view, chosen];
    for (const [i, panel] of this._panels.entries()) if (i === this._shown || panel.always) panel.fill(...this._filled);
  }
}

/** The robots that a view is about: all, or the one whose map is shown. */
const about = (live, view) => (view < 0 ? live.robots : [live.robots[view]]).filter((robot) => robot?.told);

/** Known area over time. */
export class AreaPanel {
  constructor(theme) {
    this.name = "area";
    this.title = "Area";
    this.element = make("div");
    const canvas = make("canvas", undefined, "chart");
    this.element.append(canvas, make("p", "Known area of each robot's global map", "hint"));
    this._chart = new Chart(canvas, theme, "m²");
    this._theme = theme;
  }

  fill(live) {
    drawStreams(this._chart, this._theme, live, "area", (item) => item[1]);
  }
}

function drawStreams(chart, theme, live, stream, value) {
  const span = { begin: live.begin, end: Math.max(live.now, live.begin + 10) };
  const lines = live.robots.map((robot, i) => {
    const items = robot.stream(stream).filter(([time]) => time >= span.begin);
    return { time: items.map((item) => item[0]), value: items.map(value), colour: theme.colour(i), width: 1.5 };
  });
  chart.paint(span, lines);
  chart.draw(span.end, lines.map((one) => ({ value: one.value.at(-1) ?? null, colour: one.colour, radius: 2.5 })));
}

/** All bids of the newest auctions, those that lost, too, and who chose what and why. */
export class ChoicePanel {
  /** `changed()`: another auction is to be seen on the map. */
  constructor(theme, changed) {
    this.name = "choices";
    this.title = "Auctions";
    this.element = make("div");
    const list = make("ol", undefined, "list"), auctions = make("div");
    this.element.append(auctions, make("h3", "Goals"), list);
    this._filled = new Filled(list);
    this._auctions = new AuctionHistory(auctions, theme, "in the map of who holds the auction", changed);
    this._theme = theme;
  }

  /** The auction that is to be seen on the map; null: none. */
  get pointedAt() {
    return this.element.hidden ? null : this._auctions.pointedAt;
  }

  fill(live, view, chosen) {
    this._auctions.fill(live.auctions(about(live, chosen)), live.begin, live.robots.map(({ name }) => name));
    const all = about(live, view).flatMap((robot) => robot.stream("choices").slice(-30).map((item) => ({ robot, item })));
    all.sort((a, b) => b.item[0] - a.item[0]);
    const newest = all.slice(0, 40);
    this._filled.fill([this._theme.dark, newest.map(({ robot, item }) => [robot.name, item[0]])], () => (
      newest.length ? newest.map((one) => this._line(live, one)) : [make("li", "No goal has been chosen yet.", "hint")]
    ));
  }

  _line(live, { robot, item: [time, x, y, reason, bids, unit] }) {
    const item = make("li"), text = make("div");
    text.append(make("b", robot.name), ` to (${fixed(x, 1)}, ${fixed(y, 1)}): ${reason || "no reason given"}`);
    const told = Object.entries(bids).map(([name, bid]) => `${name} ${bidText(bid, unit)}`);
    if (told.length) text.append(make("div", `bids: ${told.join(" · ")}`, "hint"));
    item.append(make("time", clock(time - live.begin)), swatch(this._theme, live.number(robot.name)), text);
    return item;
  }
}

/** Whose map is placed in whose, or why not. */
export class PlacePanel {
  constructor(theme) {
    this.name = "places";
    this.title = "Places";
    this.element = make("div");
    this._filled = new Filled(this.element);
    this._theme = theme;
  }

  fill(live, view) {
    const told = about(live, view).map((robot) => [robot.name, robot.values.merger ?? { robots: [], wants_to_meet: [] }]);
    this._filled.fill([this._theme.dark, told], () => told.flatMap(([name, merger]) => this._robot(live, name, merger)));
  }

  _robot(live, name, { robots, wants_to_meet: wanted }) {
    const head = make("h3"), list = make("ul", undefined, "list"), others = robots.filter(({ robot }) => robot !== name);
    head.append(swatch(this._theme, live.number(name)), `In the map of ${name}`);
    for (const other of others) list.append(placement(other));
    if (!others.length) list.append(make("li", "no robot has been heard of", "hint"));
    return [head, list, ...(wanted.length ? [make("p", `would like to meet ${wanted.join(", ")}`, "hint")] : [])];
  }
}

function placement({ robot, placed, why, via, pose: [x, y, yaw], confidence }) {
  const item = make("li"), text = make("div");
  item.append(make("span", placed ? "✓" : "✗", placed ? "right" : "wrong"), text);
  text.append(make("b", robot), ` ${placed ? "placed" : "not placed"}${via ? ` through ${via}` : ""}: ${why}`);
  if (placed) {
    const degrees = fixed((yaw * 180) / Math.PI, 1);
    text.append(make("div", `at ${fixed(x, 2)} m, ${fixed(y, 2)} m, ${degrees}°, confidence ${confidence.toFixed(2)}`, "hint"));
  }
  return item;
}

/** Links with their loss, routes, groups, traffic. */
export class RadioPanel {
  constructor(theme) {
    this.name = "radio";
    this.title = "Radio";
    this.element = make("div");
    const canvas = make("canvas", undefined, "chart"), tables = make("div");
    this.element.append(make("h3", "Sent, kbit/s"), canvas, tables);
    this._chart = new Chart(canvas, theme, "kbit/s");
    this._filled = new Filled(tables);
    this._theme = theme;
  }

  fill(live, view) {
    drawStreams(this._chart, this._theme, live, "traffic", (item) => item[1] / 125);
    const told = about(live, view).filter((robot) => robot.values.network);
    this._filled.fill([this._theme.dark, told.map(({ values }) => values.network)], () => [
      make("h3", "Loss of frames, from the robot of the row to that of the column"), lossTable(this._theme, live, told),
      make("h3", "Traffic"), trafficTable(told),
      make("h3", "Routes"), routeTable(told),
      make("h3", "Groups"), groupTable(told),
    ]);
  }
}

function lossTable(theme, live, told) {
  const names = live.robots.map((robot) => robot.name);
  const cell = ({ values, name }, other) => {
    const link = values.network.links.find(({ robot }) => robot === other);
    if (!link) return name === other ? "·" : "";
    const text = `${Math.round(100 * link.loss)} %`;
    return make("span", link.two_way ? text : `(${text})`, link.loss > 0.5 || !link.two_way ? "wrong" : link.loss < 0.1 ? "right" : "failed");
  };
  const heads = names.map((name) => name.replace(/^robot_/, ""));
  return table(["", ...heads], told.map((robot) => [robot.name, ...names.map((name) => cell(robot, name))]));
}

function trafficTable(told) {
  return table(["Robot", "Sent", "Received", "↑ kbit/s", "↓ kbit/s", "Failed", "Waiting"], told.map((robot) => {
    const { network } = robot.values, [, out, into] = robot.stream("traffic").at(-1) ?? [0, 0, 0];
    return [
      robot.name, bytes(network.bytes_sent), bytes(network.bytes_received), kilobits(out), kilobits(into),
      `${network.packets_failed}/${network.packets_sent}`, String(network.waiting),
    ];
  }));
}

function routeTable(told) {
  const rows = told.flatMap(({ name, values }) => values.network.routes.filter(({ hops }) => hops > 1)
    .map(({ to, via, hops, cost }) => [name, to, via, String(hops), cost.toFixed(1)]));
  return rows.length ? table(["From", "To", "Over", "Hops", "Cost"], rows) : make("p", "All that are reached are neighbours.", "hint");
}

function groupTable(told) {
  const rows = told.flatMap(({ name, values }) => values.network.groups.filter(({ member, root }) => member || root)
    .map(({ group, root, connected, uplink, downlinks }) => [
      name, group, root ? "root" : connected ? uplink || "connected" : "not connected", downlinks.join(", ") || null,
    ]));
  return rows.length ? table(["Robot", "Group", "Up", "Down"], rows) : make("p", "No groups.", "hint");
}

/** Events and what the nodes say. */
export class LogPanel {
  constructor() {
    this.name = "log";
    this.title = "Log";
    this.always = true;
    this.events = []; // {at, robot, kind, text}, by time
    this.element = make("div");
    this.element.append(Object.assign(make("ol", undefined, "list"), { id: "events" }));
    this._seen = new WeakMap();
  }

  fill(live) {
    this._list ??= new EventList(400);
    const fresh = live.robots.flatMap((robot) => this._fresh(live, robot)).sort((a, b) => a.at - b.at);
    this._list.add(fresh, live.begin);
    this.events = [...this.events, ...fresh].slice(-1000);
    if (this.element.hidden) return;
    const count = this.events.filter(({ kind }) => kind === "error" || kind === "fatal").length;
    setText(this._count ??= this.element.appendChild(make("p", "", "hint")), count ? `${count} errors` : "");
  }

  /** What is told next is told whole. */
  reset() {
    this.events = [];
    this._list?.clear();
    this._seen = new WeakMap();
  }

  /** To the newest. */
  shown() {
    const list = byId("events");
    list.scrollTop = list.scrollHeight;
  }

  /** What a robot has told since the last time. */
  _fresh(live, robot) {
    const index = live.number(robot.name), last = this._seen.get(robot) ?? { events: 0, log: 0 };
    const events = robot.since("events", last.events), log = robot.since("log", last.log);
    this._seen.set(robot, { events: events.end, log: log.end });
    return [
      ...events.items.map(([at, kind, text]) => ({ at, robot: index, kind, text })),
      ...log.items.map(([at, kind, node, text]) => ({ at, robot: index, kind, text: `${robot.name} ${node}: ${text}` })),
    ];
  }
}
