// What a running team tells, as a source of scenes. Values and streams are described in mr_page.watch and stream.

import { MOST } from "./auctions.js";
import { placed } from "./layers.js";
import { TiledMap } from "./tiled_map.js";

export const TEAM = -1; // the view in which all maps lie where they are in the world
const KEPT = { trail: 6000, auctions: MOST }; // items of a stream; of the others
const KEPT_OTHERS = 2500;
const OTHER_CLOCK = 3600; // s between two clocks that are not the same
const MARGIN = 0.6; // m around everything
const LEAST = 8; // m that are shown
const FLASH = 5; // s for which something that happens is to be seen
const HERE = { x: 0, y: 0, yaw: 0 };

/** One robot. `told`: it has a feed, so that more is known of it than others say. */
class LiveRobot {
  constructor(name, told) {
    this.name = name;
    this.told = told;
    this.heard = null; // what it has told others over the radio, see mr_page.ros_values.team_values
    this.values = {};
    this.shift = 0; // s that its clock is ahead of the team's
    this._streams = {};
    this._ends = {}; // number of the next item of each
    this.maps = emptyMaps();
    this.path = { x: [], y: [], run: 0 };
  }

  /** Newest last; their times are those of the team's clock. */
  stream(name) {
    const items = this._streams[name] ?? [];
    return this.shift && name !== "trail" ? items.map(([time, ...rest]) => [time - this.shift, ...rest]) : items;
  }

  /** The items behind number `from` that are still there, and the number for the next call. */
  since(name, from) {
    const end = this._ends[name] ?? 0;
    return { items: end > from ? this.stream(name).slice(from - end) : [], end };
  }

  get time() {
    return this.values.time === undefined ? undefined : this.values.time - this.shift;
  }

  get begin() {
    return this.values.begin === undefined ? undefined : this.values.begin - this.shift;
  }

  take({ values = {}, streams = {} }) {
    Object.assign(this.values, values);
    for (const [name, [first, items]] of Object.entries(streams)) {
      this._ends[name] = first + items.length;
      const kept = (this._streams[name] ??= []), most = KEPT[name] ?? KEPT_OTHERS;
      kept.push(...items);
      if (kept.length > 1.2 * most) kept.splice(0, kept.length - most);
      if (name === "trail") this._extendPath(items, kept);
    }
  }

  _extendPath(items, kept) {
    const { path } = this;
    for (const [x, y] of items) {
      path.x.push(x);
      path.y.push(y);
    }
    if (path.x.length > kept.length) {
      Object.assign(path, { x: kept.map((point) => point[0]), y: kept.map((point) => point[1]), run: path.run + 1 });
    }
  }

  get stage() {
    const { lost, decision, state } = this.values;
    if (!this.told) return this.heard ? (this.heard.in_reach ? this.heard.state || "–" : "out of reach") : "–";
    if (lost) return "no news";
    return decision?.paused ? "paused" : state?.state ?? "–";
  }

  /** Whether it has a body; a base station has none. */
  get hasBody() {
    return !this.values.about?.base;
  }

  /** Pose in its own map frame, null while it is not known. */
  get pose() {
    const { pose, lost } = this.values;
    return pose ? { x: pose[0], y: pose[1], yaw: pose[2], silent: Boolean(lost) } : null;
  }

  /** How many others it has placed, so that its merged map holds theirs. */
  get placedOthers() {
    const others = this.values.merger?.robots ?? [];
    return others.filter(({ robot, placed: known }) => known && robot !== this.name).length;
  }

  /** Where it believes that the map frame of another robot lies in its own. */
  placeOf(other) {
    if (other === this.name) return HERE;
    const found = this.values.merger?.robots.find(({ robot, placed: known }) => robot === other && known);
    return found ? pose(found.pose) : null;
  }
}

const pose = ([x, y, yaw]) => ({ x, y, yaw });
const emptyMaps = () => ({ local: new TiledMap(), global: new TiledMap() });

export class Live {
  constructor(theme) {
    this.robots = []; // by name
    this._theme = theme;
  }

  /** Forget everything: what comes next is told whole. */
  reset() {
    this.robots = [];
  }

  /** Know what an update tells and nothing else. Pictures of maps are kept and painted where they differ. */
  become(update) {
    const kept = new Map(this.robots.map((robot) => [robot.name, robot.maps]));
    this.robots = [];
    for (const name of update.anew) this._find(name).maps = kept.get(name) ?? emptyMaps();
    for (const { name, maps } of this.robots) {
      for (const [kind, map] of Object.entries(maps)) {
        const lattice = update.maps.find(([robot, one]) => robot === name && one === kind)?.slice(2);
        map.become(lattice, update.tiles.filter((tile) => tile.robot === name && tile.kind === kind));
      }
    }
    this.apply({ ...update, anew: [], maps: [], tiles: [] });
  }

  apply(update) {
    for (const name of update.anew) this.robots = this.robots.filter((robot) => robot.name !== name);
    for (const name of update.anew) this._add(name, true);
    for (const [name, changes] of Object.entries(update.robots)) this._find(name).take(changes);
    for (const [name, kind, ...lattice] of update.maps) this._find(name).maps[kind].restart(...lattice);
    for (const { robot, kind, row, column, octets } of update.tiles) this._find(robot).maps[kind].set(row, column, octets);
    this._addPeers();
    this._findShifts();
  }

  /** Whether it is known where the maps of all lie in the world. */
  get hasTeamView() {
    return this.robots.some((robot) => robot.values.about?.start);
  }

  get now() {
    return Math.max(0, ...this.robots.map((robot) => robot.time ?? 0));
  }

  /** When it began, s. */
  get begin() {
    const times = this.robots.map((robot) => robot.begin).filter((time) => time !== undefined);
    return times.length ? Math.min(...times) : 0;
  }

  /**
   * Name of the robot whose merged map is made of the most maps, of several the one that knows most; `kept` as long as
   * no other one has placed more, so that the map does not turn all the time. Empty while nobody has placed anybody.
   */
  mostMerged(kept) {
    const merged = this.robots.filter((robot) => robot.told && !robot.values.lost && robot.placedOthers);
    const most = Math.max(...merged.map((robot) => robot.placedOthers));
    const best = merged.filter((robot) => robot.placedOthers === most);
    const area = ({ values }) => values.decision?.area ?? 0;
    return (best.find(({ name }) => name === kept) ?? best.sort((a, b) => area(b) - area(a))[0])?.name ?? "";
  }

  number(name) {
    return this.robots.findIndex((robot) => robot.name === name);
  }

  /** [robot, kind] of the maps that a view shows. */
  mapsOf(view) {
    const told = this.robots.filter((robot) => robot.told);
    if (view === TEAM) return told.map(({ name }) => [name, "local"]);
    const shown = this.robots[view];
    return shown?.told ? [[shown.name, "global"], ...told.map(({ name }) => [name, "local"])] : [];
  }

  /** The newest auctions of some robots, as an AuctionHistory lists them. */
  auctions(robots) {
    const held = robots.flatMap((robot) => robot.stream("auctions").map(([at, number, unit, offers]) => (
      { key: `${robot.name} ${number} ${at}`, robot: robot.name, at, unit, offers }
    )));
    return held.sort((a, b) => b.at - a.at).slice(0, MOST);
  }

  /** `show`: {merged, own}: which maps. `auction`: that is to be seen, null: none. */
  scene(view, show, auction = null) {
    const places = this.robots.map((robot) => this._place(view, robot)), now = this.now;
    return {
      view,
      bounds: this._bounds(view, places),
      walls: null,
      maps: () => this._maps(view, places, show),
      mapsKey: JSON.stringify([view, show, places, this.robots.map(({ maps }) => [maps.local.version, maps.global.version])]),
      robots: this.robots.map((robot, i) => this._robot(robot, places[i], view, now)),
      links: this.links(),
      merges: this._merges(now),
      auction: this._auction(view, auction),
    };
  }

  /** Radio links {a, b, both, loss: the worse of both directions}, a < b by their numbers. */
  links() {
    const found = new Map();
    this.robots.forEach((robot, from) => {
      for (const link of robot.values.lost ? [] : robot.values.network?.links ?? []) {
        const to = this.number(link.robot), pair = `${Math.min(from, to)} ${Math.max(from, to)}`, other = found.get(pair);
        if (to < 0) continue;
        const loss = Math.max(link.loss, other?.loss ?? 0);
        found.set(pair, { a: Math.min(from, to), b: Math.max(from, to), both: link.two_way || Boolean(other?.both), loss });
      }
    });
    return [...found.values()];
  }

  _find(name) {
    return this._add(name, true);
  }

  _add(name, told) {
    const before = this.robots.find((robot) => robot.name === name);
    if (before) return Object.assign(before, { told: before.told || told });
    const robot = new LiveRobot(name, told);
    this.robots.push(robot);
    this.robots.sort((a, b) => a.name.localeCompare(b.name, "en", { numeric: true }));
    return robot;
  }

  /** Robots of which only others tell. */
  _addPeers() {
    for (const { values } of [...this.robots]) {
      for (const { robot } of values.merger?.robots ?? []) this._add(robot, false);
      for (const name of values.network?.robots ?? []) this._add(name, false);
      for (const [name, heard] of Object.entries(values.team?.robots ?? {})) this._add(name, false).heard = heard;
    }
  }

  /** A base station of a simulated team has no simulated time, for example. */
  _findShifts() {
    const time = this.robots.find((robot) => robot.hasBody && robot.values.time !== undefined)?.values.time;
    for (const robot of this.robots) {
      const ahead = (robot.values.time ?? time) - time;
      robot.shift = Math.abs(ahead) > OTHER_CLOCK ? ahead : 0;
    }
  }

  /** The map frame of a robot in the frame of a view, null where it is not known. */
  _place(view, robot) {
    if (view !== TEAM) return this.robots[view]?.placeOf(robot.name) ?? null;
    const start = robot.values.about?.start;
    return start ? pose(start) : null;
  }

  _robot(robot, place, view, now) {
    const own = robot.pose, peer = this.robots[view]?.values.peers?.[robot.name];
    const entry = { name: robot.name, pose: null, path: null, goal: null, radioOff: Boolean(robot.values.radio_off) };
    if (!robot.told || !place) return peer ? { ...entry, pose: { x: peer[0], y: peer[1], yaw: null, silent: false } } : entry;
    const at = ([x, y]) => placed(place, x, y), { decision, plan, frontiers, clusters } = robot.values;
    const key = [robot.path.run, place.x, place.y, place.yaw].join(" "), goal = decision?.goal ? at(decision.goal) : null;
    const [x, y] = own ? at([own.x, own.y]) : [];
    return {
      ...entry,
      pose: own && { x, y, yaw: place.yaw + own.yaw, silent: own.silent },
      path: { x: robot.path.x, y: robot.path.y, count: robot.path.x.length, place, key },
      goal: goal && { x: goal[0], y: goal[1] },
      plan: goal && plan?.map(at),
      frontiers: frontiers?.map(at),
      clusters: clusters?.map((cluster) => cluster.map(at)),
      auctions: robot.stream("choices").slice(-3)
        .map(([time]) => ({ age: (now - time) / FLASH, text: "" })).filter(({ age }) => age >= 0 && age <= 1),
    };
  }

  _auction(view, auction) {
    const robot = this.robots[this.number(auction?.robot)], place = robot && this._place(view, robot);
    if (!place) return null;
    return { clusters: auction.offers.map(([x, y, , by]) => [...placed(place, x, y), this.number(by)]) };
  }

  _merges(now) {
    return this.robots.flatMap((robot, a) => robot.stream("events").slice(-20)
      .filter(([time, kind]) => now - time <= FLASH && now >= time && (kind === "placed" || kind === "revoked"))
      .map(([time, kind, , other]) => ({ a, b: this.number(other), kind, age: (now - time) / FLASH })));
  }

  _maps(view, places, show) {
    const found = [], add = (i, kind, tinted) => {
      const picture = this.robots[i].maps[kind].picture(this._theme.mapColours(i, tinted), places[i]);
      if (picture) found.push(picture);
    };
    if (view !== TEAM && show.merged && places[view]) add(view, "global", false);
    if (show.own) this.robots.forEach((robot, i) => robot.told && places[i] && add(i, "local", true));
    return found;
  }

  /** Of all that is known in a view, with a margin. */
  _bounds(view, places) {
    const points = [];
    this.robots.forEach((robot, i) => {
      if (!places[i]) return;
      for (const map of [robot.maps.local, ...(i === view ? [robot.maps.global] : [])]) points.push(...corners(map, places[i]));
      if (robot.pose) points.push(placed(places[i], robot.pose.x, robot.pose.y));
    });
    const [left, right] = range(points.map((point) => point[0])), [bottom, top] = range(points.map((point) => point[1]));
    return [left, bottom, right, top];
  }
}

/** Least and greatest value with a margin, at least LEAST apart. */
function range(values) {
  if (!values.length) return [-LEAST / 2, LEAST / 2];
  const least = Math.min(...values), greatest = Math.max(...values);
  const margin = Math.max(MARGIN, (LEAST - (greatest - least)) / 2);
  return [least - margin, greatest + margin];
}

function corners(map, place) {
  const { box } = map;
  if (!box) return [];
  const corner = map.corner(place), [left, bottom, right, top] = box;
  return [[left, bottom], [right, bottom], [right, top], [left, top]].map(([x, y]) => placed(corner, x, y));
}
