// The page of a recorded mission: plays a Record.

import { Chart } from "./chart.js";
import { bytes, byId, clamp, clock, make, setText } from "./dom.js";
import { EventList } from "./event_list.js";
import { MapView } from "./map_view.js";
import { Record } from "./record.js";
import { RobotTable } from "./robot_table.js";
import { between, valueAt } from "./series.js";
import { Theme } from "./theme.js";
import { TimeLine } from "./time_line.js";

const SPEEDS = [1, 5, 20, 60];
const LAYERS = { walls: "true walls", paths: "paths", goals: "goals", links: "radio links", names: "names" };
const COLUMNS = [
  { title: "State" }, { title: "Driven" }, { title: "Knows", hint: "Free area in its own global map" },
  { title: "Own", hint: "Free area in its own local map" }, { title: "Sent" },
  { title: "Links", hint: "Radio neighbours now" },
];
const SOURCES = {
  snapshots: "Maps: snapshots taken during the mission",
  reconstructed: "Maps reconstructed: the final maps, uncovered as the true paths suggest",
  seen: "Maps reconstructed from the true walls: the record has none",
  none: "No maps in this record",
};

const data = JSON.parse(byId("data").textContent);
const state = { time: 0, playing: false, speed: 20, view: -1, last: 0 };
const span = { begin: 0, end: data.end, now: 0 };
const theme = new Theme(() => { paintChart(); redraw(); });
const record = new Record(data, theme);
const map = new MapView(theme, LAYERS, () => redraw());
const marks = new TimeLine(theme, seek);
const chart = new Chart(byId("chart"), theme, "m²", seek);
const table = new RobotTable(theme, COLUMNS, (index) => choose(state.view === index ? -1 : index));
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
  const area = between(data.team, "explored", state.time), coverage = between(data.team, "coverage", state.time);
  const dots = data.robots.map((robot, i) => ({
    value: between(robot.series, "explored", state.time), colour: theme.colour(i), radius: 2.5,
  }));
  chart.draw(state.time, [...dots, { value: area, colour: theme.css.text, radius: 4 }]);
  const share = coverage === null ? "" : `, coverage ${(100 * coverage).toFixed(0)} %`;
  setText(byId("explored"), area === null ? "" : `team ${area.toFixed(0)} m²${share}`);
}

function fillTable() {
  const links = record.linksAt(state.time);
  const rows = data.robots.map((robot, index) => {
    const value = (name, show) => { const v = valueAt(robot.series, name, state.time); return v === null ? "–" : show(v); };
    const stage = record.stateText(robot, state.time), area = (v) => `${v.toFixed(0)} m²`;
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
  table.fill(rows, state.view);
}

let waiting = false;
function redraw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame((now) => { waiting = false; frame(now); });
}

function frame(now) {
  if (state.playing) {
    state.time = Math.min(data.end, state.time + clamp((now - state.last) / 1000, 0, 0.2) * state.speed);
    if (state.time >= data.end) setPlaying(false);
  }
  state.last = now;
  span.now = state.time;
  const mapsKey = state.playing ? Math.floor(now / 100) : `at ${state.time}`; // maps at most ten times a second anew
  map.draw(record.scene(state.time, state.view, state.speed, mapsKey));
  marks.draw(span, data.events, data.robots.map((robot) => robot.auctionTimes));
  drawChart();
  fillTable();
  events.mark(data.events.findLastIndex((event) => event.at <= state.time + 1e-6));
  byId("slider").value = state.time;
  setText(byId("clock"), `${clock(state.time)} / ${clock(data.end)}`);
  if (state.playing) redraw();
}

function setPlaying(playing) {
  if (playing && state.time >= data.end) state.time = 0;
  state.playing = playing;
  state.last = performance.now();
  byId("play").textContent = playing ? "❚❚ Pause" : "▶ Play";
  redraw();
}

function seek(time) {
  state.time = clamp(time, 0, data.end);
  redraw();
}

function setSpeed(speed) {
  state.speed = speed;
  for (const one of byId("speeds").children) one.setAttribute("aria-pressed", String(Number(one.value) === speed));
}

function choose(view) {
  state.view = view;
  byId("view").value = String(view);
  describeSource();
  redraw();
}

function describeSource() {
  const robots = state.view < 0 ? data.robots.keys() : [state.view], kinds = new Set();
  for (const robot of robots) {
    const number = data.views[robot][state.view < 0 ? "team" : "alone"];
    kinds.add(data.snapshots[robot].length ? "snapshots" : number === null ? "none" : data.layers[number].source);
  }
  const box = byId("source");
  box.textContent = [...kinds].map((kind) => SOURCES[kind]).join(" · ");
  box.className = kinds.has("reconstructed") || kinds.has("seen") ? "made" : "";
}

function buildControls() {
  for (const speed of SPEEDS) {
    const one = make("button", `${speed}×`);
    Object.assign(one, { type: "button", value: speed });
    one.addEventListener("click", () => setSpeed(speed));
    byId("speeds").append(one);
  }
  const view = byId("view");
  view.append(new Option("the team", "-1"), ...data.robots.map((robot, i) => new Option(robot.name, String(i))));
  view.addEventListener("change", () => choose(Number(view.value)));
  byId("slider").max = data.end;
  byId("slider").addEventListener("input", (event) => seek(Number(event.target.value)));
  byId("play").addEventListener("click", () => setPlaying(!state.playing));
  byId("theme").addEventListener("click", () => theme.apply(!theme.dark));
}

function fillHead() {
  const badge = byId("status"), status = data.outcome.status || "outcome not recorded";
  badge.textContent = status;
  badge.classList.add(data.outcome.status || "unknown");
  const time = data.exploration_time === null ? "" : `explored in ${clock(data.exploration_time)}`;
  byId("reason").textContent = [data.outcome.reason, time].filter(Boolean).join(" · ");
  byId("failure").hidden = !data.outcome.traceback;
  byId("traceback").textContent = data.outcome.traceback;
  byId("notes").append(...data.notes.map((note) => make("li", note)));
  for (const [name, value] of Object.entries(data.trial)) byId("trial").append(make("dt", name), make("dd", String(value)));
  events.add(data.events, 0);
  if (!data.events.length) byId("events").append(make("li", "none recorded"));
}

const KEYS = {
  " ": () => setPlaying(!state.playing),
  ArrowLeft: (event) => seek(state.time - (event.shiftKey ? 30 : 5)),
  ArrowRight: (event) => seek(state.time + (event.shiftKey ? 30 : 5)),
  ArrowUp: () => setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, SPEEDS.indexOf(state.speed) + 1)]),
  ArrowDown: () => setSpeed(SPEEDS[Math.max(0, SPEEDS.indexOf(state.speed) - 1)]),
  Home: () => seek(0), End: () => seek(data.end),
  "+": () => map.camera.zoom(1.4), "-": () => map.camera.zoom(1 / 1.4), "0": () => map.camera.showAll(),
};

function listenToKeys() {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "SELECT") return;
    // Buttons, boxes and summaries keep what space means to them.
    if (event.key === " " && ["BUTTON", "SUMMARY"].includes(event.target.tagName)) return;
    if (event.key === " " && event.target.type === "checkbox") return;
    if (!KEYS[event.key]) return;
    event.preventDefault();
    KEYS[event.key](event);
  });
}

async function begin() {
  buildControls();
  fillHead();
  setSpeed(20);
  listenToKeys();
  new ResizeObserver(() => { paintChart(); redraw(); }).observe(document.body);
  choose(-1);
  await record.load();
  const asked = /[#&]t=([\d.]+)/.exec(window.location.hash);
  seek(asked ? Number(asked[1]) : 0);
  setPlaying(false);
}

begin();
