// The page of a running robot or team.

import { CommandBar } from "./commands.js";
import { Connection } from "./connection.js";
import { byId, bytes, clock, setName, setText } from "./dom.js";
import { Live, TEAM } from "./live.js";
import { MapView } from "./map_view.js";
import { AreaPanel, ChoicePanel, LogPanel, PlacePanel, RadioPanel, Tabs } from "./panels.js";
import { Past } from "./past.js";
import { Playback } from "./playback.js";
import { RobotTable } from "./robot_table.js";
import { Theme } from "./theme.js";
import { TimeLine } from "./time_line.js";

const LAYERS = {
  merged: "merged map", own: "own maps", paths: "paths", frontiers: "frontiers", clusters: "clusters",
  goals: "goals", links: "radio links", names: "names",
};
const COLUMNS = [
  { title: "State" }, { title: "Driven" }, { title: "Knows", hint: "What is known, free and walls, in its own map merged with those of others" },
  { title: "Left", hint: "Frontiers and clusters" }, { title: "Sent" }, { title: "Links", hint: "Radio neighbours" },
  { title: "Placed", hint: "Robots whose maps it has placed, of those that it has heard of" },
];

// For measurements: updates that came, and when (ms) the maps in view were there for the first time.
window.page = { updates: 0, mapsAt: null };

const PANELS_PERIOD = 250; // ms; nobody reads faster

let view = null; // number of the robot whose map is shown, TEAM, or null until there is one
let chosen = null; // name of that robot, empty for the team; null until somebody has chosen
let merged = ""; // name of the robot that is shown until then, empty while no maps are merged
let connected = null; // not known before the first try has ended
let panelsAt = -Infinity; // when tables and panels were filled, ms
const refresh = () => {
  panelsAt = -Infinity;
  redraw();
};
const theme = new Theme(refresh);
const live = new Live(theme);
const playback = new Playback({ live: true, changed: refresh });
const map = new MapView(theme, LAYERS, () => redraw());
const marks = new TimeLine(theme, (time) => playback.seek(time));
const table = new RobotTable(theme, COLUMNS, (index) => choose(clicked(shown.robots[index].name)));
const log = new LogPanel();
const choices = new ChoicePanel(theme, () => redraw());
const tabs = new Tabs([new AreaPanel(theme), choices, new PlacePanel(theme), new RadioPanel(theme), log]);
const connection = new Connection({
  took: (update) => {
    live.apply(update);
    window.page.updates++;
    if (update.tiles.length && !update.rest) window.page.mapsAt ??= performance.now();
    redraw();
  },
  tookPast: (update) => {
    past.take(update);
    refresh();
  },
  answered: (answer) => commands.answered(answer),
  changed: (now) => {
    connected = now;
    if (now) {
      live.reset();
      log.reset();
      past.reset();
    } else commands.lost();
    redraw();
  },
});
const past = new Past(theme, (time) => connection.askForPast(time));
const commands = new CommandBar((...order) => connection.order(...order));
let shown = live; // what is to be seen: it, or the past

/** The robots that can be looked at as the options of the list of views, and the view that is chosen. */
function findView() {
  const names = shown.robots.filter((robot) => robot.told).map((robot) => robot.name);
  const options = [...(shown.hasTeamView ? [["the team", ""]] : []), ...names.map((name) => [name, name])];
  const select = byId("view"), key = JSON.stringify(options);
  if (select.dataset.key !== key) {
    select.dataset.key = key;
    select.replaceChildren(...options.map(([text, value]) => new Option(text, value)));
  }
  merged = shown.mostMerged(merged);
  const wanted = options.find(([, value]) => value === (chosen ?? merged)) ?? options[0];
  view = !wanted ? null : wanted[1] === "" ? TEAM : shown.number(wanted[1]);
  if (wanted) select.value = wanted[1];
}

/** What is to be seen at the place on the time line: what is told now, or what was told then. */
function findShown() {
  playback.extend(live.begin, live.now);
  const moving = playback.step(performance.now()), before = shown;
  if (!playback.following) past.lookAt(playback.time);
  shown = playback.following || !past.known ? live : past.team;
  if (shown !== before) log.reset();
  return moving;
}

/** What is chosen by a click on the row of a robot: it, or, where it was, the team. */
function clicked(name) {
  return chosen === name && shown.hasTeamView ? "" : name;
}

function choose(name) {
  chosen = name;
  commands.choose(name);
  refresh();
}

let waiting = false;
function redraw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame((now) => { waiting = false; frame(now); });
}

/** So that tables and panels have what was told last when nothing more is told. */
let later = null;
function redrawLater() {
  later ??= setTimeout(() => { later = null; redraw(); }, PANELS_PERIOD);
}

function frame(now) {
  if (findShown()) redraw();
  findView();
  fillHead();
  if (view === null) return;
  if (connection.lookAt(shown.mapsOf(view))) past.askAgain();
  describeMaps();
  map.draw(shown.scene(view, map.show, choices.pointedAt));
  if (now - panelsAt < PANELS_PERIOD) {
    redrawLater();
    return;
  }
  panelsAt = now;
  fillTable();
  tabs.fill(shown, view, chosen ? view : TEAM);
  const span = { begin: live.begin, end: Math.max(live.now, live.begin + 10), now: playback.time };
  marks.draw(span, log.events, live.robots.map((robot) => robot.stream("choices").map(([time]) => time)));
  commands.fill(live.robots);
}

function fillHead() {
  const told = shown.robots.filter((robot) => robot.told && robot.hasBody), stages = told.map((robot) => robot.stage);
  const finished = told.filter(({ values }) => values.state?.finished).length;
  const base = shown.robots.find((robot) => robot.told && !robot.hasBody);
  const none = base ? "base station" : "waiting for robots";
  const badge = connected === null ? "connecting" : !connected ? "no connection" : !told.length ? none : finished === told.length ? "finished" : "";
  const stage = badge || ["exploring", "returning", "waiting", "paused", "starting"].find((one) => stages.includes(one)) || "–";
  setText(byId("status"), stage);
  setName(byId("status"), `badge ${connected !== false ? { finished: "finished", exploring: "exploring" }[stage] ?? "" : "failed"}`);
  const one = told.length === 1 ? told[0] : shown.robots[view] ?? base;
  const texts = one?.told ? [one.values.state?.text, one.values.decision?.ended_by, one.values.team?.text] : [];
  const rest = Math.max(...told.filter(({ values }) => !values.decision?.paused).map(({ values }) => values.decision?.rest ?? -1));
  const when = shown === live ? "" : `as it was at ${clock(shown.now - live.begin)}`;
  const reason = [when, rest > 0 ? `about ${clock(rest)} left` : "", ...texts].filter(Boolean).join(" · ");
  setText(byId("reason"), reason);
  byId("reason").title = reason;
  document.body.classList.toggle("past", shown !== live);
  setText(byId("summary"), told.length > 1 ? `${finished} of ${told.length} finished` : "");
}

function describeMaps() {
  map.offer("merged", view !== TEAM);
  const robot = shown.robots[view], lost = view === TEAM ? [] : shown.robots.filter(({ name }) => !robot.placeOf(name));
  const missing = lost.length ? `; not placed: ${lost.map(({ name }) => name).join(", ")}` : "";
  const text = view === TEAM ? "The robots' own maps, each where it began" : `The map of ${robot.name}, and what each robot saw of it`;
  setText(byId("source"), text + missing);
}

function fillTable() {
  const links = shown.links();
  table.fill(shown.robots.map((robot, index) => {
    const { values } = robot, area = values.decision?.area ?? robot.heard?.area, others = values.merger?.robots.filter((other) => other.robot !== robot.name);
    const linked = links.filter(({ a, b }) => a === index || b === index).length;
    return {
      name: robot.name,
      texts: [
        robot.stage,
        values.driven === undefined ? "–" : `${values.driven.toFixed(0)} m`,
        area === undefined || area === null ? "–" : `${area.toFixed(0)} m²`,
        values.state ? `${values.state.frontiers}/${values.state.clusters}` : "–",
        values.network ? bytes(values.network.bytes_sent) : "–",
        robot.told ? String(linked) : "–",
        others ? `${others.filter(({ placed }) => placed).length}/${others.length}` : "–",
      ],
      hint: values.state?.text ?? heardOf(robot),
      pale: !robot.told || Boolean(values.lost),
    };
  }), view);
}

/** In words, what a robot of which only others tell has said over the radio. */
function heardOf({ name, heard }) {
  if (!heard) return `${name} is known from others`;
  const { text, merging, age, order, answered, answer } = heard;
  const told = [text, merging, order && `${order}: ${answered ? answer : "no answer yet"}`].filter(Boolean).join(" · ");
  return age === null ? `${name} has told nothing yet` : `${told || name}${age >= 10 ? `, ${age} s ago` : ""}`;
}

playback.keys(map.keys);
byId("view").addEventListener("change", (event) => choose(event.target.value));
byId("theme").addEventListener("click", () => theme.apply(!theme.dark));
new ResizeObserver(refresh).observe(document.body);
redraw();
