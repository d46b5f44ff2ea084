// A recorded mission as a source of scenes. What `data` holds is described in mr_experiments.replay.replay.

import { MOST } from "./auctions.js";
import { clamp } from "./dom.js";
import { Film, GrowingMap, loadImage, painted } from "./record_maps.js";
import { indexAt, valueAt } from "./series.js";
import { rgb } from "./theme.js";

const WORLD = { x: 0, y: 0, yaw: 0 };
const SILENT = 5; // s without a sample

export class Record {
  constructor(data, theme) {
    this.data = data;
    this._theme = theme;
    this._wallsImage = null;
    this._walls = { canvas: null, dark: null };
    this._layers = [];
    this._films = [];
    for (const robot of data.robots) robot.auctionTimes = robot.auctions.map((auction) => auction.at);
    const held = data.robots.map(({ name, auctions }) => auctions.map((one, i) => ({ ...one, key: `${name} ${i}`, robot: name })));
    this._auctions = new Map([...held.entries(), [-1, held.flat().sort((a, b) => a.at - b.at)]]); // by view
  }

  async load() {
    const { data } = this;
    if (data.walls) this._wallsImage = await loadImage(data.walls.png);
    for (const source of data.layers) {
      const image = await loadImage(source.png);
      this._layers.push(image ? new GrowingMap(source, image, data.step) : null);
    }
    for (const [robot, frames] of data.snapshots.entries()) {
      const images = await Promise.all(frames.map((frame) => loadImage(frame.png)));
      this._films.push(frames.length ? new Film(robot, frames, images) : null);
    }
  }

  /**
   * What is to be seen at a time. `view`: number of the robot whose map is shown, -1 for the team; `speed`: s of the
   * mission in a second, from which follows how long something that happens is to be seen; maps are drawn anew when
   * `mapsKey` is another. `auction`: that is to be seen, null: none.
   */
  scene(time, view, speed, mapsKey, auction) {
    const { data } = this, length = clamp(speed * 0.5, 2, Math.max(2, data.end / 40));
    return {
      view,
      bounds: data.bounds,
      walls: this._wallsPicture(),
      maps: () => this._maps(time, view),
      mapsKey: `${mapsKey} ${view}`,
      robots: data.robots.map((robot, index) => this._robot(robot, index, time, length)),
      links: this.linksAt(time).map(([, , a, b, both]) => ({ a, b, both, loss: null })),
      merges: data.merges
        .map((merge) => ({ a: merge.by, b: merge.with, kind: merge.kind, age: (time - merge.at) / length }))
        .filter(({ age, b }) => age >= 0 && age <= 1 && b !== null),
      auction: auction && { clusters: auction.offers.map(([x, y, , by]) => [x, y, data.robots.findIndex(({ name }) => name === by)]) },
    };
  }

  linksAt(time) {
    const { links, end: last } = this.data;
    return links.filter(([begin, end]) => begin <= time && (time < end || (time >= last && end >= last)));
  }

  /** Pose between the samples; `silent` long before the first and after the last one, before joining and after death. */
  poseAt(robot, time) {
    const pose = poseOfSeries(robot, time);
    if (pose && (absent(robot, time) || dead(robot, time))) pose.silent = true;
    return pose;
  }

  stateText(robot, time) {
    const { data } = this, pose = this.poseAt(robot, time);
    if (!pose || absent(robot, time)) return "not here yet";
    if (dead(robot, time)) return "dead";
    if (robot.series.x && pose.silent && time < data.end + 1) return "silent";
    const number = valueAt(robot.series, "state", time);
    return number === null ? "–" : data.states[number] ?? String(number);
  }

  /** The newest auctions that had been opened by then in a view, as they stood, as an AuctionHistory lists them. */
  auctionsAt(time, view) {
    const held = this._auctions.get(view), begun = indexAt(held.map(({ at }) => at), time) + 1;
    return held.slice(Math.max(0, begun - MOST), begun).reverse().map((auction) => standing(auction, time));
  }

  _robot(robot, index, time, length) {
    const { series } = robot, goal = goalAt(robot, time, this.data.end);
    return {
      name: robot.name,
      pose: this.poseAt(robot, time),
      path: series.x ? { x: series.x, y: series.y, count: indexAt(series.time, time) + 1, place: WORLD, key: index } : null,
      goal,
      auctions: this._openings(robot, time, length),
      body: this.data.footprints[index],
    };
  }

  _openings(robot, time, length) {
    const found = [];
    for (let i = indexAt(robot.auctionTimes, time); i >= 0 && time - robot.auctionTimes[i] < length; i--) {
      const count = robot.auctions[i].clusters;
      found.push({ age: (time - robot.auctionTimes[i]) / length, text: count ? `auction of ${count}` : "auction" });
    }
    return found;
  }

  _wallsPicture() {
    if (!this._wallsImage) return null;
    if (this._walls.dark !== this._theme.dark) {
      const truth = rgb(this._theme.css.truth);
      this._walls = { canvas: painted(this._wallsImage, { free: truth, wall: truth }), dark: this._theme.dark };
    }
    return { canvas: this._walls.canvas, matrix: this.data.walls.matrix };
  }

  /** Pictures of the maps in view at a time, with their places. */
  _maps(time, view) {
    const { data } = this, team = view < 0, result = [];
    for (let robot = 0; robot < data.robots.length; robot++) {
      if (!team && robot !== view) continue;
      const film = this._films[robot], layer = this._layers[data.views[robot][team ? "team" : "alone"]];
      const picture = film ? film.at(time, this._theme) : layer?.at(time, this._theme, team && data.robots.length > 1);
      if (picture) result.push(picture);
    }
    return result;
  }
}

/** An auction as it stood at a time: with its result, as far as one is recorded, or with the bids that had come. */
function standing({ answered, decided, clusters, ...auction }, time) {
  const { offers, robot } = auction, count = `${clusters} cluster${clusters === 1 ? "" : "s"}`;
  if (decided === null) return { ...auction, note: offers.length ? "" : `${count}, no result is recorded`, state: "undated" };
  if (time >= decided) return { ...auction, note: "", state: "decided" };
  const come = new Set([robot, ...Object.keys(answered).filter((name) => answered[name] <= time)]);
  const bids = (all) => Object.fromEntries(Object.entries(all).filter(([name]) => come.has(name)));
  return {
    ...auction,
    offers: offers.map(([x, y, all]) => [x, y, bids(all), ""]),
    note: `open: ${count}, ${come.size - 1} other${come.size === 2 ? " has" : "s have"} answered`,
    state: `open ${come.size}`,
  };
}

const absent = (robot, time) => robot.joined !== null && time < robot.joined;
const dead = (robot, time) => robot.died !== null && time >= robot.died;
const goalAt = (robot, time, end) => robot.goals.find((goal) => goal.set <= time && time < (goal.end ?? end + 1)) ?? null;

function poseOfSeries(robot, time) {
  const s = robot.series;
  if (!s.x) return robot.start ? { x: robot.start[0], y: robot.start[1], yaw: robot.start[2], silent: true } : null;
  const i = indexAt(s.time, time);
  if (i < 0) return { x: s.x[0], y: s.y[0], yaw: s.yaw[0], silent: s.time[0] - time > SILENT };
  if (i === s.time.length - 1) return { x: s.x[i], y: s.y[i], yaw: s.yaw[i], silent: time - s.time[i] > SILENT };
  const share = (time - s.time[i]) / (s.time[i + 1] - s.time[i] || 1);
  const turn = Math.atan2(Math.sin(s.yaw[i + 1] - s.yaw[i]), Math.cos(s.yaw[i + 1] - s.yaw[i]));
  const step = (values) => values[i] + share * (values[i + 1] - values[i]);
  return { x: step(s.x), y: step(s.y), yaw: s.yaw[i] + share * turn, silent: false };
}
