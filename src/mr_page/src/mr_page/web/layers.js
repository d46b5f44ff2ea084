// What lies over the maps. Each layer draws a scene, as `MapView` describes it.

import { blit, cross, disc, label, line, ring } from "./drawing.js";

const NOSE = [[-0.22, -0.19], [0.12, -0.19], [0.22, 0], [0.12, 0.19], [-0.22, 0.19]]; // m, heading right
const CLUSTER_CELL = 0.5; // m
const MANY = 6; // robots; with more, less is written and links are paler

/** A point (m) in a frame that lies at `place`, as seen from the outside. */
export function placed(place, x, y) {
  const cosine = Math.cos(place.yaw), sine = Math.sin(place.yaw);
  return [place.x + cosine * x - sine * y, place.y + sine * x + cosine * y];
}

const paled = (scene, index) => (scene.view >= 0 && scene.view !== index ? 0.4 : 1);

/** All paths so far. They stay on a canvas of their own, so that a frame adds only what is new. */
export class Trails {
  constructor() {
    this._canvas = document.createElement("canvas");
    this._key = "";
    this._drawn = new Map();
  }

  draw(context, ratio, view, scene) {
    const { camera, theme } = view;
    const key = JSON.stringify([camera.key, theme.dark, scene.view, scene.robots.map((robot) => robot.path?.key)]);
    const fewer = scene.robots.some((robot, i) => (robot.path?.count ?? 0) < (this._drawn.get(i) ?? 0));
    if (key !== this._key || fewer) {
      Object.assign(this._canvas, { width: camera.canvas.width, height: camera.canvas.height }); // clears it
      this._key = key;
      this._drawn.clear();
    }
    const inner = this._canvas.getContext("2d");
    inner.setTransform(ratio, 0, 0, ratio, 0, 0);
    scene.robots.forEach((robot, i) => robot.path && this._extend(inner, view, scene, robot, i));
    blit(context, this._canvas, 0.85);
    scene.robots.forEach((robot, i) => robot.path && robot.pose && lastStep(context, view, scene, robot, i));
  }

  _extend(context, { camera, theme }, scene, { path }, index) {
    const begin = this._drawn.get(index) ?? 0, at = (i) => camera.toScreen(...placed(path.place, path.x[i], path.y[i]));
    if (path.count <= begin) return;
    context.beginPath();
    for (let i = Math.max(0, begin - 1); i < path.count; i++) context.lineTo(...at(i));
    context.globalAlpha = paled(scene, index);
    context.strokeStyle = theme.colour(index);
    context.lineWidth = 1.7;
    context.lineJoin = "round";
    context.stroke();
    if (begin === 0) ring(context, ...at(0), 3.5, theme.colour(index), 1.5);
    this._drawn.set(index, path.count);
  }
}

function lastStep(context, { camera, theme }, scene, { path, pose }, index) {
  if (!path.count) return;
  const last = path.count - 1;
  context.globalAlpha = 0.85 * paled(scene, index);
  const from = camera.toScreen(...placed(path.place, path.x[last], path.y[last]));
  line(context, from, camera.toScreen(pose.x, pose.y), theme.colour(index), 1.7);
  context.globalAlpha = 1;
}

export function drawLinks(context, { camera, theme }, scene) {
  const many = scene.robots.length > MANY;
  for (const { a, b, both, loss } of scene.links) {
    const from = scene.robots[a]?.pose, to = scene.robots[b]?.pose;
    if (!from || !to) continue;
    const start = camera.toScreen(from.x, from.y), end = camera.toScreen(to.x, to.y);
    const bad = (loss ?? 0) > 0.5 ? theme.css.warn : theme.css.accent;
    context.globalAlpha = many ? 0.35 : 0.6;
    line(context, start, end, bad, both ? 1.6 : 1.2, both ? [] : [2, 4]);
    context.globalAlpha = 1;
    if (loss >= 0.005 && Math.hypot(end[0] - start[0], end[1] - start[1]) > 70) {
      const text = `${Math.round(100 * loss)} %`;
      label(context, text, (start[0] + end[0]) / 2, (start[1] + end[1]) / 2 + 4, bad, theme.css.halo, 10);
    }
  }
}

/** Places of maps that have just been found or given up. */
export function drawMerges(context, { camera, theme }, scene) {
  for (const { a, b, age, kind } of scene.merges) {
    const from = scene.robots[a]?.pose, to = scene.robots[b]?.pose;
    if (!from || !to) continue;
    context.globalAlpha = 1 - age;
    line(context, camera.toScreen(from.x, from.y), camera.toScreen(to.x, to.y), theme.mergeColour(kind), 5);
    context.globalAlpha = 1;
  }
}

export function drawClusters(context, { camera, theme }, scene) {
  const side = Math.max(3, CLUSTER_CELL * camera.scale);
  scene.robots.forEach((robot, i) => {
    context.globalAlpha = 0.22 * paled(scene, i);
    context.fillStyle = theme.colour(i);
    context.beginPath(); // of all, so that what overlaps is no darker
    for (const point of (robot.clusters ?? []).flat()) {
      const [x, y] = camera.toScreen(...point);
      context.rect(x - side / 2, y - side / 2, side, side);
    }
    context.fill();
    context.globalAlpha = 1;
  });
}

export function drawFrontiers(context, { camera, theme }, scene) {
  const radius = Math.min(3.5, Math.max(1.2, 0.06 * camera.scale));
  scene.robots.forEach((robot, i) => {
    context.globalAlpha = 0.75 * paled(scene, i);
    for (const point of robot.frontiers ?? []) disc(context, ...camera.toScreen(...point), radius, theme.colour(i));
    context.globalAlpha = 1;
  });
}

export function drawGoals(context, { camera, theme }, scene) {
  scene.robots.forEach((robot, i) => {
    const { goal, plan, pose } = robot;
    if (!goal || !pose || pose.silent) return;
    const [x, y] = camera.toScreen(goal.x, goal.y), colour = theme.colour(i);
    context.globalAlpha = paled(scene, i);
    if (plan?.length) dashes(context, [...plan, [goal.x, goal.y]].map((point) => camera.toScreen(...point)), colour);
    else line(context, camera.toScreen(pose.x, pose.y), [x, y], colour, 1.2, [6, 4]);
    cross(context, x, y, 5, colour, 2.2);
    ring(context, x, y, 8, colour, 1.2);
    context.globalAlpha = 1;
  });
}

function dashes(context, points, style) {
  context.beginPath();
  for (const point of points) context.lineTo(...point);
  context.setLineDash([6, 4]);
  context.strokeStyle = style;
  context.lineWidth = 1.2;
  context.stroke();
  context.setLineDash([]);
}

/** Rings around robots that have just chosen a goal. */
export function drawAuctions(context, { camera, theme }, scene) {
  scene.robots.forEach((robot, i) => {
    if (!robot.pose) return;
    const [x, y] = camera.toScreen(robot.pose.x, robot.pose.y);
    for (const { age, text } of robot.auctions ?? []) {
      context.globalAlpha = 1 - age;
      ring(context, x, y, 10 + 22 * age, theme.colour(i), 2.5);
      const written = text && (scene.robots.length <= MANY || scene.view === i);
      if (written) label(context, text, x, y + 26, theme.colour(i), theme.css.halo);
      context.globalAlpha = 1;
    }
  });
}

/** The clusters of an auction in the colours of those who explore them, and rings around these. */
export function drawAuction(context, { camera, theme }, { auction, robots }) {
  const ringed = (x, y, radius, style) => {
    ring(context, x, y, radius, theme.css.halo, 7);
    ring(context, x, y, radius, style, 3);
  };
  for (const [x, y, by] of auction?.clusters ?? []) {
    const at = camera.toScreen(x, y), style = by < 0 ? theme.css.soft : theme.colour(by);
    ringed(...at, 11, style);
    disc(context, ...at, 4, style);
  }
  for (const by of new Set(auction?.clusters.map((cluster) => cluster[2]))) {
    const pose = robots[by]?.pose;
    if (pose) ringed(...camera.toScreen(pose.x, pose.y), 17, theme.colour(by));
  }
}

export function drawRobots(context, view, scene) {
  scene.robots.forEach((robot, i) => robot.pose && drawRobot(context, view, robot, i));
}

function drawRobot(context, { camera, theme }, { pose, body, radioOff }, index) {
  const size = Math.max(1, 9 / 0.22 / camera.scale); // never smaller than one can see
  const large = body?.length && size === 1, colour = theme.colour(index);
  context.globalAlpha = pose.silent ? 0.4 : 1;
  const outline = (polygon, scale, alpha) => shape(context, camera, polygon, pose, scale, colour, theme.css.wall, alpha);
  if (large) for (const polygon of body) outline(polygon, 1, 0.45);
  if (pose.yaw === null) disc(context, ...camera.toScreen(pose.x, pose.y), 6, colour);
  else outline(NOSE, size * (large ? 0.85 : 1), 1);
  if (radioOff) cross(context, ...camera.toScreen(pose.x, pose.y), 9, theme.css.wrong, 2.5);
  context.globalAlpha = 1;
}

function shape(context, camera, polygon, pose, size, fill, edge, alpha) {
  const before = context.globalAlpha;
  context.beginPath();
  for (const [x, y] of polygon) context.lineTo(...camera.toScreen(...placed(pose, size * x, size * y)));
  context.closePath();
  context.globalAlpha = before * alpha;
  context.fillStyle = fill;
  context.fill();
  context.strokeStyle = edge;
  context.lineWidth = 1;
  context.stroke();
  context.globalAlpha = before;
}

export function drawNames(context, { camera, theme }, scene) {
  scene.robots.forEach((robot, i) => {
    if (!robot.pose) return;
    const [x, y] = camera.toScreen(robot.pose.x, robot.pose.y);
    label(context, robot.name, x, y - 14, theme.colour(i), theme.css.halo);
  });
}
