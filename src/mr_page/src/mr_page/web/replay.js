// The page of a recorded mission: plays a Record.

import { AuctionHistory } from "./auctions.js";
import { Chart } from "./chart.js";
import { bytes, byId, clock, make, setText } from "./dom.js";
import { EventList } from "./event_list.js";
import { MapView } from "./map_view.js";
import { Playback } from "./playback.js";
import { Record } from "./record.js";
import { RobotTable } from "./robot_table.js";
import { between, valueAt } from "./series.js";
import { Theme } from "./theme.js";
import { TimeLine } from "./time_line.js";

const LAYERS = { walls: "true walls", paths: "paths", goals: "goals", links: "radio links", names: "names" };
const COLUMNS = [
  { title: "State" }, { title: "Driven" }, { title: "Knows", hint: "Free area in its map merged with those of others" },
  { title: "Own", hint: "Free area in the map that it made itself" }, { title: "Sent" },
  { title: "Links", hint: "Radio neighbours now" },
];
const SOURCES = {
  snapshots: "Maps: snapshots taken during the mission",
  reconstructed: "Maps reconstructed: the final maps, uncovered as the true paths suggest",
  seen: "Maps reconstructed from the true walls: the record has none",
  none: "No maps in this record",
};

const data = JSON.parse(byId("data").textContent);
let view = -1;
const playback = new Playback({ live: false, changed: () => redraw() });
const seek = (time) => playback.seek(time);
const span = { begin: 0, end: data.end, now: 0 };
const theme = new Theme(() => { paintChart(); redraw(); });
const record = new Record(data, theme);
const map = new MapView(theme, LAYERS, () => redraw());
const marks = new TimeLine(theme, seek);
const chart = new Chart(byId("chart"), theme, "m²", seek);
const table = new RobotTable(theme, COLUMNS, (index) => choose(view === index ? -1 : index));
const auctions = new AuctionHistory(byId("auctions"), theme, "in the world", () => redraw());
const names = data.robots.map(({ name }) => name);
const events = new EventList(Infinity, (event) => seek(event.at));

function paintChart() {
  const lines = data.robots.map((robot, i) => ({ series: robot.series, colour: theme.colour(i), width: 1.2 }));
  lines.push({ series: data.team, colour: theme.css.text, width: 2.4 });
  chart.paint(
    span,
    lines.filter(({ series }) => series.time && series.explored)
      .map(({ series, colour, width }) => ({ time: series.time, value: series.explored, colour, width })),
    data.merges.map(({ at, kind }) => ({ at, colour: theme.mergeColour(kind) })),
  );
}

function drawChart() {
  const area = between(data.team, "explored", playback.time), coverage = between(data.team, "coverage", playback.time);
  const dots = data.robots.map((robot, i) => ({
    value: between(robot.series, "explored", playback.time), colour: theme.colour(i), radius: 2.5,
  }));
  chart.draw(playback.time, [...dots, { value: area, colour: theme.css.text, radius: 4 }]);
  const share = coverage === null ? "" : `, coverage ${(100 * coverage).toFixed(0)} %`;
  setText(byId("explored"), area === null ? "" : `team ${area.toFixed(0)} m²${share}`);
  byId("explored").title = "True floor, but for 0.1 m beside walls, that the own map of any robot knows, counted once";
}

function fillTable() {
  const links = record.linksAt(playback.time);
  const rows = data.robots.map((robot, index) => {
    const value = (name, show) => { const v = valueAt(robot.series, name, playback.time); return v === null ? "–" : show(v); };
    const stage = record.stateText(robot, playback.time), area = (v) => `${v.toFixed(0)} m²`;
    const linked = links.filter((link) => link[2] === index || link[3] === index).length;
    return {
      name: robot.name,
      texts: [
        stage, value("distance", (v) => `${v.toFixed(1)} m`), value("explored", area), value("own", area),
        value("bytes", bytes), data.links.length ? String(linked) : "–",
      ],
      hint: `Show the map of ${robot.name}`,
      pale: ["silent", "dead", "not here yet"].includes(stage),
    };
  });
  table.fill(rows, view);
}

let waiting = false;
function redraw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame((now) => { waiting = false; frame(now); });
}

function frame(now) {
  const again = playback.step(now), { time } = playback;
  span.now = time;
  const mapsKey = again ? Math.floor(now / 100) : `at ${time}`; // maps at most ten times a second anew
  auctions.fill(record.auctionsAt(time, view), 0, names);
  map.draw(record.scene(time, view, playback.speed, mapsKey, auctions.pointedAt));
  marks.draw(span, data.events, data.robots.map((robot) => robot.auctionTimes));
  drawChart();
  fillTable();
  events.mark(data.events.findLastIndex((event) => event.at <= time + 1e-6));
  if (again) redraw();
}

function choose(chosen) {
  view = chosen;
  byId("view").value = String(view);
  describeSource();
  redraw();
}

function describeSource() {
  const robots = view < 0 ? data.robots.keys() : [view], kinds = new Set();
  for (const robot of robots) {
    const number = data.views[robot][view < 0 ? "team" : "alone"];
    kinds.add(data.snapshots[robot].length ? "snapshots" : number === null ? "none" : data.layers[number].source);
  }
  const box = byId("source");
  box.textContent = [...kinds].map((kind) => SOURCES[kind]).join(" · ");
  box.className = kinds.has("reconstructed") || kinds.has("seen") ? "made" : "";
}

function buildControls() {
  const select = byId("view");
  select.append(new Option("the team", "-1"), ...data.robots.map((robot, i) => new Option(robot.name, String(i))));
  select.addEventListener("change", () => choose(Number(select.value)));
  byId("theme").addEventListener("click", () => theme.apply(!theme.dark));
  playback.extend(0, data.end);
  playback.keys(map.keys);
}

function fillHead() {
  const badge = byId("status"), status = data.outcome.status || "outcome not recorded";
  badge.textContent = status;
  badge.classList.add(data.outcome.status || "unknown");
  const time = data.exploration_time === null ? "" : `explored in ${clock(data.exploration_time)}`;
  byId("reason").textContent = byId("reason").title = [data.outcome.reason, time].filter(Boolean).join(" · ");
  byId("failure").hidden = !data.outcome.traceback;
  byId("traceback").textContent = data.outcome.traceback;
  byId("notes").append(...data.notes.map((note) => make("li", note)));
  for (const [name, value] of Object.entries(data.trial)) byId("trial").append(make("dt", name), make("dd", String(value)));
  const held = data.robots.flatMap((robot) => robot.auctions).filter(({ offers }) => offers.length);
  byId("auctionbox").hidden = !held.length;
  byId("undated").hidden = held.every(({ decided }) => decided !== null);
  events.add(data.events, 0);
  if (!data.events.length) byId("events").append(make("li", "none recorded"));
}

async function begin() {
  buildControls();
  fillHead();
  new ResizeObserver(() => { paintChart(); redraw(); }).observe(document.body);
  choose(-1);
  await record.load();
  const asked = /[#&]t=([\d.]+)/.exec(window.location.hash);
  seek(asked ? Number(asked[1]) : 0);
}

begin();
