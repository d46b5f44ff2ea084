"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);
  const many = data.robots.length > 6; // then less is written and links are paler
  const SPEEDS = [1, 5, 20, 60];
  const OCCUPIED_BELOW = 100, FREE_ABOVE = 230; // gray values in the pictures
  const NOSE = [[-0.22, -0.19], [0.12, -0.19], [0.22, 0], [0.12, 0.19], [-0.22, 0.19]]; // m, heading right
  const PALETTE = { // [light, dark], the order in which robots get them
    colours: [
      ["#d62728", "#ff6b6b"], ["#1f77b4", "#5fb0ee"], ["#2ca02c", "#5fd068"], ["#e07b00", "#ffb14d"],
      ["#8a5cc0", "#bd96ee"], ["#0f9fb3", "#4fd6e6"], ["#8c564b", "#cf9a8c"], ["#d5539f", "#f595cd"],
      ["#6b7a00", "#c3d24a"], ["#2f3fbf", "#8d9bff"], ["#00796b", "#3fc7b4"], ["#a8324a", "#f07f97"],
      ["#5f6b7a", "#aebaca"], ["#b08900", "#f2d14b"], ["#3d7a1e", "#9be06a"], ["#7a1fa2", "#dc8cff"],
    ],
  };

  const state = {
    time: 0, playing: false, speed: 20, view: -1, dark: false, css: {}, last: 0, drawn: -1,
    show: { walls: true, paths: true, goals: true, links: true, names: true },
    camera: { x: 0, y: 0, scale: 1, fitted: true },
  };

  const colour = (robot) => PALETTE.colours[robot % PALETTE.colours.length][state.dark ? 1 : 0];
  const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
  const clock = (seconds) => {
    const whole = Math.floor(seconds + 1e-6);
    const hours = Math.floor(whole / 3600), minutes = Math.floor(whole / 60) % 60;
    const tail = `${String(minutes).padStart(hours ? 2 : 1, "0")}:${String(whole % 60).padStart(2, "0")}`;
    return hours ? `${hours}:${tail}` : tail;
  };
  const bytes = (n) => n >= 1e9 ? `${(n / 1e9).toFixed(2)} GB` : n >= 1e6 ? `${(n / 1e6).toFixed(1)} MB` : n >= 1e3 ? `${(n / 1e3).toFixed(0)} kB` : `${n} B`;
  const make = (tag, text, name) => {
    const element = document.createElement(tag);
    if (text !== undefined) element.textContent = text;
    if (name) element.className = name;
    return element;
  };
  const setText = (element, text) => { if (element.textContent !== text) element.textContent = text; };

  /** Number of the last time that is not after `time`, -1 before the first. */
  function indexAt(times, time) {
    let low = 0, high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] <= time) low = middle + 1; else high = middle;
    }
    return low - 1;
  }

  /** Value of a series at a time, null where it is not known. The first sample counts a little earlier, too. */
  function valueAt(series, name, time) {
    if (!series.time || !series[name]) return null;
    const index = indexAt(series.time, time + (time < series.time[0] ? 1 : 0));
    return index < 0 ? null : series[name][index];
  }

  /** Value between two samples of a series, null where it is not known. */
  function between(series, name, time) {
    const before = valueAt(series, name, time), next = before === null ? -1 : indexAt(series.time, time) + 1;
    if (next < 1 || next >= series.time.length || series[name][next] === null) return before;
    const begin = series.time[next - 1], length = series.time[next] - begin;
    return before + (length > 0 ? (time - begin) / length : 0) * (series[name][next] - before);
  }

  /** Pose between the samples; `silent` long before the first and after the last one, before joining and after death. */
  function poseAt(robot, time) {
    const pose = poseOfSeries(robot, time);
    if (pose && (absent(robot, time) || robot.died !== null && time >= robot.died)) pose.silent = true;
    return pose;
  }

  const absent = (robot, time) => robot.joined !== null && time < robot.joined;

  function poseOfSeries(robot, time) {
    const s = robot.series;
    if (!s.x) return robot.start ? { x: robot.start[0], y: robot.start[1], yaw: robot.start[2], silent: true } : null;
    const i = indexAt(s.time, time);
    if (i < 0) return { x: s.x[0], y: s.y[0], yaw: s.yaw[0], silent: s.time[0] - time > 5 };
    if (i === s.time.length - 1) return { x: s.x[i], y: s.y[i], yaw: s.yaw[i], silent: time - s.time[i] > 5 };
    const share = (time - s.time[i]) / (s.time[i + 1] - s.time[i] || 1);
    const turn = Math.atan2(Math.sin(s.yaw[i + 1] - s.yaw[i]), Math.cos(s.yaw[i + 1] - s.yaw[i]));
    return { x: s.x[i] + share * (s.x[i + 1] - s.x[i]), y: s.y[i] + share * (s.y[i + 1] - s.y[i]), yaw: s.yaw[i] + share * turn, silent: false };
  }

  const goalAt = (robot, time) => robot.goals.find((goal) => goal.set <= time && time < (goal.end ?? data.end + 1)) ?? null;
  const linksAt = (time) => data.links.filter(([begin, end]) => begin <= time && (time < end || (time >= data.end && end >= data.end)));
  /** Length of a flash in mission time: long enough to be seen at this speed, short beside the mission. */
  const flash = () => clamp(state.speed * 0.5, 2, Math.max(2, data.end / 40));

  /** Red, green and blue of a colour written as #rrggbb. */
  const rgb = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
  const mixed = (a, b, share) => [0, 1, 2].map((i) => Math.round(a[i] + share * (b[i] - a[i])));

  function loadImage(uri) {
    return new Promise((done) => {
      const image = new Image();
      image.onload = () => done(image);
      image.onerror = () => done(null);
      image.src = uri;
    });
  }

  function pixelsOf(image) {
    const canvas = document.createElement("canvas");
    canvas.width = image.width;
    canvas.height = image.height;
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.drawImage(image, 0, 0);
    return { canvas, context, image: context.getImageData(0, 0, image.width, image.height) };
  }

  /** Colours of free space and walls; free space takes a tint of a robot's colour. */
  function mapColours(robot, tinted) {
    const free = rgb(state.css.free), wall = rgb(state.css.wall);
    return { free: tinted ? mixed(free, rgb(colour(robot)), state.dark ? 0.22 : 0.17) : free, wall };
  }

  /** A map that grows: only cells that change are painted. */
  class Layer {
    constructor(source, image) {
      this.matrix = source.matrix;
      this.robot = source.robot;
      Object.assign(this, pixelsOf(image));
      const pixels = this.image.data, cells = [];
      this.classes = new Uint8Array(pixels.length / 4);
      this.since = new Uint16Array(pixels.length / 4);
      for (let i = 0; i < this.classes.length; i++) {
        this.classes[i] = pixels[4 * i] < OCCUPIED_BELOW ? 1 : pixels[4 * i] > FREE_ABOVE ? 2 : 0;
        this.since[i] = pixels[4 * i + 1] * 256 + pixels[4 * i + 2];
        if (this.classes[i]) cells.push(i);
      }
      this.order = Uint32Array.from(cells).sort((a, b) => this.since[a] - this.since[b]);
      this.clear();
    }

    clear() {
      this.image.data.fill(0);
      this.painted = 0;
      this.style = "";
      this.changed = true;
    }

    paintTo(time, tinted) {
      const style = `${state.dark} ${tinted}`;
      if (style !== this.style) {
        this.clear();
        this.style = style;
        this.colours = mapColours(this.robot, tinted);
      }
      const step = Math.floor(time / data.step + 1e-6), pixels = this.image.data;
      while (this.painted < this.order.length && this.since[this.order[this.painted]] <= step) this.set(this.order[this.painted++], pixels, 255);
      while (this.painted > 0 && this.since[this.order[this.painted - 1]] > step) this.set(this.order[--this.painted], pixels, 0);
      if (this.changed) this.context.putImageData(this.image, 0, 0);
      this.changed = false;
      return this.canvas;
    }

    set(cell, pixels, alpha) {
      const [r, g, b] = this.classes[cell] === 1 ? this.colours.wall : this.colours.free;
      pixels[4 * cell] = r;
      pixels[4 * cell + 1] = g;
      pixels[4 * cell + 2] = b;
      pixels[4 * cell + 3] = alpha;
      this.changed = true;
    }
  }

  /** Snapshots of one robot's global map; coloured when first shown, the last few are kept. */
  class Film {
    constructor(robot, frames, images) {
      this.robot = robot;
      this.frames = frames.map((frame, i) => ({ ...frame, image: images[i] })).filter((frame) => frame.image);
      this.times = this.frames.map((frame) => frame.time);
      this.ready = new Map();
    }

    at(time) {
      const index = indexAt(this.times, time);
      if (index < 0) return null;
      const key = `${index} ${state.dark}`;
      if (!this.ready.has(key)) {
        if (this.ready.size > 8) this.ready.delete(this.ready.keys().next().value);
        this.ready.set(key, painted(this.frames[index].image, mapColours(this.robot, false)));
      }
      return { canvas: this.ready.get(key), matrix: this.frames[index].matrix };
    }
  }

  /** A class picture in colours; what is unknown is clear. */
  function painted(image, { free, wall }) {
    const { canvas, context, image: picture } = pixelsOf(image);
    const pixels = picture.data;
    for (let i = 0; i < pixels.length; i += 4) {
      const paint = pixels[i] < OCCUPIED_BELOW ? wall : pixels[i] > FREE_ABOVE ? free : null;
      if (paint) [pixels[i], pixels[i + 1], pixels[i + 2]] = paint;
      pixels[i + 3] = paint ? 255 : 0;
    }
    context.putImageData(picture, 0, 0);
    return canvas;
  }

  const art = { walls: null, wallsImage: null, layers: [], films: [] };

  async function loadPictures() {
    if (data.walls) art.wallsImage = await loadImage(data.walls.png);
    for (const source of data.layers) {
      const image = await loadImage(source.png);
      art.layers.push(image ? new Layer(source, image) : null);
    }
    for (const [robot, frames] of data.snapshots.entries()) {
      art.films.push(frames.length ? new Film(robot, frames, await Promise.all(frames.map((frame) => loadImage(frame.png)))) : null);
    }
    paintWalls();
  }

  function paintWalls() {
    const truth = rgb(state.css.truth);
    art.walls = art.wallsImage ? painted(art.wallsImage, { free: truth, wall: truth }) : null;
  }

  const map = byId("map");

  function sized(canvas) {
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
    return { context, ratio, width: canvas.clientWidth, height: canvas.clientHeight };
  }

  function fit() {
    const [left, bottom, right, top] = data.bounds;
    const scale = Math.min(map.clientWidth / (right - left), map.clientHeight / (top - bottom));
    Object.assign(state.camera, { x: (left + right) / 2, y: (bottom + top) / 2, scale: Math.max(scale, 0.01), fitted: true });
  }

  function zoom(factor, px = map.clientWidth / 2, py = map.clientHeight / 2) {
    const camera = state.camera, [x, y] = toWorld(px, py);
    camera.scale = clamp(camera.scale * factor, 0.5, 2000);
    camera.x = x - (px - map.clientWidth / 2) / camera.scale;
    camera.y = y + (py - map.clientHeight / 2) / camera.scale;
    camera.fitted = false;
    redraw();
  }

  const toScreen = (x, y) => [map.clientWidth / 2 + (x - state.camera.x) * state.camera.scale, map.clientHeight / 2 - (y - state.camera.y) * state.camera.scale];
  const toWorld = (px, py) => [state.camera.x + (px - map.clientWidth / 2) / state.camera.scale, state.camera.y - (py - map.clientHeight / 2) / state.camera.scale];

  function place(context, matrix, ratio) {
    const s = state.camera.scale * ratio, [e, f] = toScreen(matrix[4], matrix[5]);
    context.setTransform(matrix[0] * s, -matrix[1] * s, matrix[2] * s, -matrix[3] * s, e * ratio, f * ratio);
  }

  function drawPicture(context, canvas, matrix, ratio) {
    context.save();
    place(context, matrix, ratio);
    const coarse = Math.hypot(matrix[0], matrix[1]) * state.camera.scale > 3;
    context.imageSmoothingEnabled = !coarse;
    context.drawImage(canvas, 0, 0);
    context.restore();
  }

  /** Pictures of the maps in view at this time, with their places. */
  function mapsInView() {
    const team = state.view < 0, result = [];
    for (let robot = 0; robot < data.robots.length; robot++) {
      if (!team && robot !== state.view) continue;
      const film = art.films[robot], number = data.views[robot][team ? "team" : "alone"];
      if (film) {
        const frame = film.at(state.time);
        if (frame) result.push(frame);
      } else if (number !== null && art.layers[number]) {
        const layer = art.layers[number];
        result.push({ canvas: layer.paintTo(state.time, team && data.robots.length > 1), matrix: layer.matrix });
      }
    }
    return result;
  }

  /** All maps on one clear canvas, walls of one over the free space of the others; at most ten times a second anew. */
  const maps = { canvas: document.createElement("canvas"), key: "", at: 0 };

  function drawMaps(context, ratio) {
    const key = JSON.stringify([viewKey(), state.view]), now = performance.now();
    if (key !== maps.key || !state.playing || now - maps.at > 100) {
      Object.assign(maps, { key, at: now });
      Object.assign(maps.canvas, { width: map.width, height: map.height }); // clears it
      const inner = maps.canvas.getContext("2d");
      inner.globalCompositeOperation = state.dark ? "lighten" : "darken";
      for (const { canvas, matrix } of mapsInView()) drawPicture(inner, canvas, matrix, ratio);
    }
    blit(context, maps.canvas, 0.88);
  }

  /** All paths so far. They stay on a canvas of their own, so that a frame adds only what is new. */
  const trail = { canvas: document.createElement("canvas"), key: "", time: 0, drawn: [] };

  function drawPaths(context, ratio, poses) {
    const key = JSON.stringify([viewKey(), state.view]), inner = trail.canvas.getContext("2d");
    if (key !== trail.key || state.time < trail.time) {
      Object.assign(trail.canvas, { width: map.width, height: map.height }); // clears it
      Object.assign(trail, { key, drawn: data.robots.map(() => 0) });
    }
    trail.time = state.time;
    inner.setTransform(ratio, 0, 0, ratio, 0, 0);
    data.robots.forEach((robot, i) => extendPath(inner, robot, i));
    blit(context, trail.canvas, 0.85);
    data.robots.forEach((robot, i) => drawLastStep(context, robot, i, poses[i]));
  }

  const viewKey = () => [state.camera, state.dark, map.width, map.height];
  const pathAlpha = (index) => state.view >= 0 && state.view !== index ? 0.4 : 1;

  function extendPath(context, robot, index) {
    const s = robot.series, begin = trail.drawn[index], end = s.x ? indexAt(s.time, state.time) : -1;
    if (end <= begin) return;
    context.beginPath();
    for (let i = begin; i <= end; i++) context.lineTo(...toScreen(s.x[i], s.y[i]));
    context.globalAlpha = pathAlpha(index);
    context.strokeStyle = colour(index);
    context.lineWidth = 1.7;
    context.lineJoin = "round";
    context.stroke();
    if (begin === 0) ring(context, ...toScreen(s.x[0], s.y[0]), 3.5, colour(index), 1.5);
    trail.drawn[index] = end;
  }

  function drawLastStep(context, robot, index, pose) {
    const s = robot.series, last = s.x ? indexAt(s.time, state.time) : -1;
    if (last < 0) return;
    context.globalAlpha = 0.85 * pathAlpha(index);
    line(context, toScreen(s.x[last], s.y[last]), toScreen(pose.x, pose.y), colour(index), 1.7);
    context.globalAlpha = 1;
  }

  /** A canvas of the size of the map over the map. */
  function blit(context, canvas, alpha) {
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.globalAlpha = alpha;
    context.drawImage(canvas, 0, 0);
    context.restore();
  }

  function ring(context, x, y, radius, style, width) {
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.strokeStyle = style;
    context.lineWidth = width;
    context.stroke();
  }

  function line(context, from, to, style, width, dash) {
    context.beginPath();
    context.moveTo(...from);
    context.lineTo(...to);
    context.setLineDash(dash || []);
    context.strokeStyle = style;
    context.lineWidth = width;
    context.stroke();
    context.setLineDash([]);
  }

  function drawGoal(context, robot, index, pose) {
    const goal = goalAt(robot, state.time);
    if (!goal || !pose || pose.silent) return;
    const [x, y] = toScreen(goal.x, goal.y);
    line(context, toScreen(pose.x, pose.y), [x, y], colour(index), 1.2, [6, 4]);
    line(context, [x - 5, y - 5], [x + 5, y + 5], colour(index), 2.2);
    line(context, [x - 5, y + 5], [x + 5, y - 5], colour(index), 2.2);
    ring(context, x, y, 8, colour(index), 1.2);
  }

  function drawLinks(context, poses) {
    for (const [, , a, b, both] of linksAt(state.time)) {
      if (!poses[a] || !poses[b]) continue;
      context.globalAlpha = many ? 0.3 : 0.6;
      line(context, toScreen(poses[a].x, poses[a].y), toScreen(poses[b].x, poses[b].y), state.css.accent, both ? 1.6 : 1.2, both ? [] : [2, 4]);
      context.globalAlpha = 1;
    }
  }

  function drawMergeFlash(context, poses) {
    const length = flash();
    for (const merge of data.merges) {
      const age = (state.time - merge.at) / length;
      if (age < 0 || age > 1 || merge.with === null || !poses[merge.by] || !poses[merge.with]) continue;
      const from = toScreen(poses[merge.by].x, poses[merge.by].y), to = toScreen(poses[merge.with].x, poses[merge.with].y);
      context.globalAlpha = 1 - age;
      line(context, from, to, mergeColour(merge.kind), 5);
      context.globalAlpha = 1;
    }
  }

  const mergeColour = (kind) => state.css[{ right: "right", wrong: "wrong" }[kind] ?? "revoked"];

  function drawAuctions(context, robot, index, pose) {
    if (!pose) return;
    const length = flash(), [x, y] = toScreen(pose.x, pose.y);
    for (let i = indexAt(robot.auctionTimes, state.time); i >= 0 && state.time - robot.auctionTimes[i] < length; i--) {
      const age = (state.time - robot.auctionTimes[i]) / length;
      context.globalAlpha = 1 - age;
      ring(context, x, y, 10 + 22 * age, colour(index), 2.5);
      const count = robot.auctions[i].clusters;
      if (!many || state.view === index) label(context, count ? `auction of ${count}` : "auction", x, y + 26, colour(index));
      context.globalAlpha = 1;
    }
  }

  function drawRobot(context, robot, index, pose) {
    const least = 9 / 0.22 / state.camera.scale, size = Math.max(1, least); // never smaller than one can see
    const body = data.footprints[index];
    context.globalAlpha = pose.silent ? 0.4 : 1;
    if (body.length && size === 1) for (const polygon of body) shape(context, polygon, pose, 1, colour(index), 0.45);
    shape(context, NOSE, pose, size * (body.length && size === 1 ? 0.85 : 1), colour(index), 1);
    context.globalAlpha = 1;
  }

  function shape(context, polygon, pose, size, fill, alpha) {
    const cosine = Math.cos(pose.yaw) * size, sine = Math.sin(pose.yaw) * size, before = context.globalAlpha;
    context.beginPath();
    for (const [x, y] of polygon) context.lineTo(...toScreen(pose.x + cosine * x - sine * y, pose.y + sine * x + cosine * y));
    context.closePath();
    context.globalAlpha = before * alpha;
    context.fillStyle = fill;
    context.fill();
    context.strokeStyle = state.css.wall;
    context.lineWidth = 1;
    context.stroke();
    context.globalAlpha = before;
  }

  function label(context, text, x, y, style, align = "center") {
    context.font = "600 12px system-ui, 'DejaVu Sans', sans-serif";
    context.textAlign = align;
    context.lineJoin = "round";
    context.lineWidth = 3.5;
    context.strokeStyle = state.css.halo;
    context.strokeText(text, x, y);
    context.fillStyle = style;
    context.fillText(text, x, y);
  }

  function drawScene() {
    if (state.camera.fitted) fit();
    const { context, ratio } = sized(map);
    const poses = data.robots.map((robot) => poseAt(robot, state.time));
    if (state.show.walls && art.walls) drawPicture(context, art.walls, data.walls.matrix, ratio);
    drawMaps(context, ratio);
    if (state.show.paths) drawPaths(context, ratio, poses);
    if (state.show.links) drawLinks(context, poses);
    drawMergeFlash(context, poses);
    if (state.show.goals) data.robots.forEach((robot, i) => drawGoal(context, robot, i, poses[i]));
    data.robots.forEach((robot, i) => drawAuctions(context, robot, i, poses[i]));
    data.robots.forEach((robot, i) => { if (poses[i]) drawRobot(context, robot, i, poses[i]); });
    if (state.show.names) data.robots.forEach((robot, i) => drawName(context, robot, i, poses[i]));
    drawScale();
  }

  function drawName(context, robot, index, pose) {
    if (!pose) return;
    const [x, y] = toScreen(pose.x, pose.y);
    label(context, robot.name, x, y - 14, colour(index));
  }

  function drawScale() {
    const metres = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find((m) => m * state.camera.scale >= 60) ?? 200;
    const bar = byId("scale").firstElementChild;
    bar.style.width = `${metres * state.camera.scale}px`;
    setText(bar, `${metres} m`);
  }

  function describeSource() {
    const robots = state.view < 0 ? data.robots.keys() : [state.view], kinds = new Set();
    for (const robot of robots) {
      const number = data.views[robot][state.view < 0 ? "team" : "alone"];
      kinds.add(data.snapshots[robot].length ? "snapshots" : number === null ? "none" : data.layers[number].source);
    }
    const texts = {
      snapshots: "Maps: snapshots taken during the mission",
      reconstructed: "Maps reconstructed: the final maps, uncovered as the true paths suggest",
      seen: "Maps reconstructed from the true walls: the record has none",
      none: "No maps in this record",
    };
    const box = byId("source");
    box.textContent = [...kinds].map((kind) => texts[kind]).join(" · ");
    box.className = kinds.has("reconstructed") || kinds.has("seen") ? "made" : "";
  }

  const PAD = 8; // px: half of the slider's thumb
  const marks = byId("marks");
  const timeX = (time, width) => PAD + (width - 2 * PAD) * clamp(time / (data.end || 1), 0, 1);
  const timeAtX = (x, width) => clamp((x - PAD) / (width - 2 * PAD), 0, 1) * data.end;

  function drawMarks() {
    const { context, width, height } = sized(marks);
    for (const [index, robot] of data.robots.entries()) {
      context.globalAlpha = 0.5;
      for (const time of robot.auctionTimes) line(context, [timeX(time, width), height - 7], [timeX(time, width), height], colour(index), 1);
      context.globalAlpha = 1;
    }
    for (const event of data.events) drawMark(context, event, timeX(event.at, width));
    const now = timeX(state.time, width);
    line(context, [now, 0], [now, height], state.css.accent, 1.5);
  }

  function drawMark(context, event, x) {
    if (event.kind === "warning") return; // there may be hundreds; they are in the list
    if (event.kind === "finished" || event.kind === "joined") {
      line(context, [x, 2], [x, 20], colour(event.robot), 1.5);
      context.fillStyle = colour(event.robot);
      context.fillRect(event.kind === "joined" ? x - 8 : x, 2, 8, 6);
    } else if (event.kind === "died") {
      line(context, [x, 2], [x, 20], colour(event.robot), 2.5);
      line(context, [x - 4, 7], [x + 4, 7], colour(event.robot), 2.5);
    } else if (event.kind === "failed") {
      line(context, [x - 3, 13], [x + 3, 19], state.css.warn, 1.5);
      line(context, [x - 3, 19], [x + 3, 13], state.css.warn, 1.5);
    } else {
      context.beginPath();
      context.moveTo(x, 1);
      context.lineTo(x + 5, 6);
      context.lineTo(x, 11);
      context.lineTo(x - 5, 6);
      context.closePath();
      context.fillStyle = mergeColour(event.kind);
      context.fill();
    }
  }

  const chart = byId("chart");
  const BOX = { left: 42, right: 20, top: 8, bottom: 22 };
  let chartPicture = null;

  const highest = () => Math.max(1, ...[data.team, ...data.robots.map((robot) => robot.series)].map((s) => (s.explored || []).reduce((most, v) => Math.max(most, v ?? 0), 0)));
  const chartTop = highest() * 1.06;
  const chartX = (time, width) => BOX.left + (width - BOX.left - BOX.right) * (time / (data.end || 1));
  const chartY = (area, height) => height - BOX.bottom - (height - BOX.top - BOX.bottom) * (area / chartTop);

  function niceStep(span, count) {
    const raw = span / count, power = 10 ** Math.floor(Math.log10(raw));
    return power * [1, 2, 5, 10].find((m) => m * power >= raw);
  }

  const timeStep = () => [5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200].find((s) => data.end / s <= 6) ?? 14400;

  function drawAxes(context, width, height) {
    context.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    context.fillStyle = state.css.soft;
    context.textAlign = "right";
    const step = niceStep(chartTop, 4);
    for (let area = 0; area <= chartTop; area += step) {
      const y = chartY(area, height);
      line(context, [BOX.left, y], [width - BOX.right, y], state.css.line, 1);
      context.fillText(`${Math.round(area * 10) / 10}`, BOX.left - 5, y + 4);
    }
    context.textAlign = "center";
    for (let time = 0; time <= data.end + 1e-6; time += timeStep()) context.fillText(clock(time), chartX(time, width), height - 6);
    context.textAlign = "left";
    context.fillText("m²", 2, BOX.top + 4);
  }

  function drawSeries(context, series, style, lineWidth, width, height) {
    if (!series.time || !series.explored) return;
    context.beginPath();
    series.time.forEach((time, i) => {
      if (series.explored[i] !== null) context.lineTo(chartX(time, width), chartY(series.explored[i], height));
    });
    context.strokeStyle = style;
    context.lineWidth = lineWidth;
    context.lineJoin = "round";
    context.stroke();
  }

  function paintChart() {
    chartPicture = document.createElement("canvas");
    const ratio = window.devicePixelRatio || 1, width = chart.clientWidth, height = chart.clientHeight;
    Object.assign(chartPicture, { width: Math.max(1, width * ratio), height: Math.max(1, height * ratio) });
    const context = chartPicture.getContext("2d");
    context.scale(ratio, ratio);
    drawAxes(context, width, height);
    for (const [index, robot] of data.robots.entries()) drawSeries(context, robot.series, colour(index), 1.2, width, height);
    drawSeries(context, data.team, state.css.text, 2.4, width, height);
    for (const merge of data.merges) {
      const x = chartX(merge.at, width);
      line(context, [x, height - BOX.bottom], [x, height - BOX.bottom - 5], mergeColour(merge.kind), 2);
    }
  }

  function drawChart() {
    const { context, width, height } = sized(chart);
    if (chartPicture) context.drawImage(chartPicture, 0, 0, width, height);
    const x = chartX(state.time, width), area = between(data.team, "explored", state.time);
    line(context, [x, BOX.top], [x, height - BOX.bottom], state.css.accent, 1.5);
    for (const [index, robot] of data.robots.entries()) dot(context, x, between(robot.series, "explored", state.time), height, colour(index), 2.5);
    dot(context, x, area, height, state.css.text, 4);
    const coverage = between(data.team, "coverage", state.time);
    const share = coverage === null ? "" : `, coverage ${(100 * coverage).toFixed(0)} %`;
    setText(byId("explored"), area === null ? "" : `team ${area.toFixed(0)} m²${share}`);
  }

  function dot(context, x, area, height, style, radius) {
    if (area === null) return;
    context.beginPath();
    context.arc(x, chartY(area, height), radius, 0, 2 * Math.PI);
    context.fillStyle = style;
    context.fill();
  }

  const rows = [];

  function buildTable() {
    data.robots.forEach((robot, index) => {
      const row = make("tr"), name = make("td"), swatch = make("span", undefined, "swatch");
      name.append(swatch, robot.name);
      const cells = Array.from({ length: 6 }, () => make("td", "–"));
      row.append(name, ...cells);
      row.title = `Show the map of ${robot.name}`;
      row.addEventListener("click", () => choose(state.view === index ? -1 : index));
      byId("robots").append(row);
      rows.push({ row, swatch, cells });
    });
  }

  function stateText(robot, time) {
    const pose = poseAt(robot, time);
    if (!pose || absent(robot, time)) return "not here yet";
    if (robot.died !== null && time >= robot.died) return "dead";
    if (robot.series.x && pose.silent && time < data.end + 1) return "silent";
    const number = valueAt(robot.series, "state", time);
    return number === null ? "–" : data.states[number] ?? String(number);
  }

  function fillTable() {
    const links = linksAt(state.time);
    data.robots.forEach((robot, index) => {
      const value = (name, show) => { const v = valueAt(robot.series, name, state.time); return v === null ? "–" : show(v); };
      const texts = [
        stateText(robot, state.time),
        value("distance", (v) => `${v.toFixed(1)} m`), value("explored", (v) => `${v.toFixed(0)} m²`), value("own", (v) => `${v.toFixed(0)} m²`),
        value("bytes", bytes), data.links.length ? String(links.filter((link) => link[2] === index || link[3] === index).length) : "–",
      ];
      texts.forEach((text, i) => setText(rows[index].cells[i], text));
      rows[index].row.className = `${state.view === index ? "chosen" : ""} ${["silent", "dead", "not here yet"].includes(texts[0]) ? "silent" : ""}`.trim();
      rows[index].swatch.style.background = colour(index);
    });
  }

  const eventItems = [];
  let eventNow = -2;

  function buildEvents() {
    for (const event of data.events) {
      const item = make("li");
      item.append(make("time", clock(event.at)), make("span", event.text, event.kind));
      item.addEventListener("click", () => seek(event.at));
      byId("events").append(item);
      eventItems.push(item);
    }
    if (!data.events.length) byId("events").append(make("li", "none recorded"));
  }

  function markEvents() {
    let now = -1;
    while (now + 1 < data.events.length && data.events[now + 1].at <= state.time + 1e-6) now++;
    if (now === eventNow) return;
    eventNow = now;
    eventItems.forEach((item, i) => { item.className = i > now ? "later" : i === now ? "now" : ""; });
    const list = byId("events"), item = eventItems[Math.max(0, now)];
    if (item) list.scrollTop = item.offsetTop - list.offsetTop - list.clientHeight / 2;
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
    drawScene();
    drawMarks();
    drawChart();
    fillTable();
    markEvents();
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
    for (const button of byId("speeds").children) button.setAttribute("aria-pressed", String(Number(button.value) === speed));
  }

  function choose(view) {
    state.view = view;
    byId("view").value = String(view);
    describeSource();
    redraw();
  }

  function setTheme(dark) {
    state.dark = dark;
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    const style = getComputedStyle(document.documentElement);
    for (const name of ["page", "panel", "line", "text", "soft", "unknown", "free", "wall", "truth", "accent", "right", "wrong", "revoked", "warn", "halo"]) {
      state.css[name] = style.getPropertyValue(`--${name}`).trim();
    }
    paintWalls();
    paintChart();
    redraw();
  }

  const LAYER_NAMES = { walls: "true walls", paths: "paths", goals: "goals", links: "radio links", names: "names" };

  function buildControls() {
    for (const speed of SPEEDS) {
      const button = make("button", `${speed}×`);
      Object.assign(button, { type: "button", value: speed });
      button.addEventListener("click", () => setSpeed(speed));
      byId("speeds").append(button);
    }
    const view = byId("view");
    view.append(new Option("the team", "-1"), ...data.robots.map((robot, i) => new Option(robot.name, String(i))));
    view.addEventListener("change", () => choose(Number(view.value)));
    for (const [name, text] of Object.entries(LAYER_NAMES)) {
      const box = make("input"), wrap = make("label");
      Object.assign(box, { type: "checkbox", checked: true });
      box.addEventListener("change", () => { state.show[name] = box.checked; redraw(); });
      wrap.append(box, text);
      byId("layers").append(wrap);
    }
    byId("slider").max = data.end;
    byId("slider").addEventListener("input", (event) => seek(Number(event.target.value)));
    byId("play").addEventListener("click", () => setPlaying(!state.playing));
    byId("closer").addEventListener("click", () => zoom(1.4));
    byId("farther").addEventListener("click", () => zoom(1 / 1.4));
    byId("fit").addEventListener("click", () => { state.camera.fitted = true; redraw(); });
    byId("theme").addEventListener("click", () => setTheme(!state.dark));
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
  }

  const KEYS = {
    " ": () => setPlaying(!state.playing),
    ArrowLeft: (event) => seek(state.time - (event.shiftKey ? 30 : 5)),
    ArrowRight: (event) => seek(state.time + (event.shiftKey ? 30 : 5)),
    ArrowUp: () => setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, SPEEDS.indexOf(state.speed) + 1)]),
    ArrowDown: () => setSpeed(SPEEDS[Math.max(0, SPEEDS.indexOf(state.speed) - 1)]),
    Home: () => seek(0), End: () => seek(data.end),
    "+": () => zoom(1.4), "-": () => zoom(1 / 1.4), "0": () => { state.camera.fitted = true; redraw(); },
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

  function listenToMap() {
    let grip = null;
    map.addEventListener("wheel", (event) => { event.preventDefault(); zoom(Math.exp(-event.deltaY * 0.0015), event.offsetX, event.offsetY); }, { passive: false });
    map.addEventListener("pointerdown", (event) => { grip = [event.clientX, event.clientY]; map.setPointerCapture(event.pointerId); });
    map.addEventListener("pointerup", () => { grip = null; });
    map.addEventListener("pointercancel", () => { grip = null; });
    map.addEventListener("pointermove", (event) => {
      if (!grip) return;
      state.camera.x -= (event.clientX - grip[0]) / state.camera.scale;
      state.camera.y += (event.clientY - grip[1]) / state.camera.scale;
      state.camera.fitted = false;
      grip = [event.clientX, event.clientY];
      redraw();
    });
    map.addEventListener("dblclick", () => { state.camera.fitted = true; redraw(); });
  }

  /** Drag over a canvas with time from left to right; `timeOf` gives the time at an x. */
  function listenToTimes(canvas, timeOf) {
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); seek(timeOf(event.offsetX)); });
    canvas.addEventListener("pointermove", (event) => { if (event.buttons) seek(timeOf(event.offsetX)); });
  }

  function listenToMarks() {
    const tip = byId("tip");
    marks.addEventListener("pointermove", (event) => {
      const near = data.events.filter((e) => e.kind !== "warning" && Math.abs(timeX(e.at, marks.clientWidth) - event.offsetX) < 6).slice(0, 4);
      tip.hidden = !near.length;
      tip.textContent = near.map((e) => `${clock(e.at)} ${e.text}`).join(" · ");
      tip.style.left = `${clamp(event.clientX - 20, 4, window.innerWidth - 350)}px`;
      tip.style.top = `${event.clientY - 44}px`;
    });
    marks.addEventListener("pointerleave", () => { tip.hidden = true; });
  }

  async function begin() {
    for (const robot of data.robots) robot.auctionTimes = robot.auctions.map((auction) => auction.at);
    buildControls();
    buildTable();
    buildEvents();
    fillHead();
    setSpeed(20);
    listenToKeys();
    listenToMap();
    listenToTimes(marks, (x) => timeAtX(x, marks.clientWidth));
    listenToTimes(chart, (x) => clamp((x - BOX.left) / (chart.clientWidth - BOX.left - BOX.right), 0, 1) * data.end);
    listenToMarks();
    const night = window.matchMedia("(prefers-color-scheme: dark)");
    setTheme(night.matches);
    night.addEventListener("change", () => setTheme(night.matches));
    new ResizeObserver(() => { paintChart(); redraw(); }).observe(document.body);
    choose(-1);
    await loadPictures();
    const asked = /[#&]t=([\d.]+)/.exec(window.location.hash);
    seek(asked ? Number(asked[1]) : 0);
    setPlaying(false);
  }

  begin();
})();
