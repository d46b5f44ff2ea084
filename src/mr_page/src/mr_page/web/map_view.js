// The team from above.

import { Camera } from "./camera.js";
import { byId, checkBox, setText } from "./dom.js";
import { blit, drawPicture, sized } from "./drawing.js";
import { Trails, drawAuction, drawAuctions, drawClusters, drawFrontiers, drawGoals, drawLinks, drawMerges, drawNames, drawRobots } from "./layers.js";

const OVER_MAPS = { // in the order in which they are drawn
  clusters: drawClusters, frontiers: drawFrontiers, links: drawLinks, goals: drawGoals,
};

/**
 * Draws scenes. A scene is what is to be seen at one moment, in m and rad of one frame:
 *
 *   view: number of the robot whose map is shown, -1 for the team; bounds: [left, bottom, right, top] of everything
 *   walls: {canvas, matrix} or null; maps: [{canvas, matrix}], which are another picture when `mapsKey` is another
 *   robots: [{name, pose: {x, y, yaw (null: not known), silent} or null, path: {x: [], y: [], count, place, key} or null,
 *     goal: {x, y} or null, plan, frontiers: [[x, y]], clusters: [[[x, y]]], auctions: [{age: 0 to 1, text}], body:
 *     [polygons], radioOff}]
 *   links: [{a, b, both, loss (0 to 1 or null)}]; merges: [{a, b, age: 0 to 1, kind}]; robots by their numbers
 *   auction: {clusters: [[x, y, number of who explores it or -1]]} that is to be seen, or null
 */
export class MapView {
  /** `layers`: {name: label} of those that can be switched; `changed()`: draw again, please. */
  constructor(theme, layers, changed) {
    const canvas = byId("map");
    this.theme = theme;
    this.camera = new Camera(canvas, changed);
    this.show = Object.fromEntries(Object.keys(layers).map((name) => [name, true]));
    this._canvas = canvas;
    this._maps = { canvas: document.createElement("canvas"), key: "" };
    this._trails = new Trails();
    this._boxes = {};
    for (const [name, text] of Object.entries(layers)) {
      this._boxes[name] = checkBox(text, true, (on) => { this.show[name] = on; changed(); });
      byId("layers").append(this._boxes[name]);
    }
    byId("closer").addEventListener("click", () => this.camera.zoom(1.4));
    byId("farther").addEventListener("click", () => this.camera.zoom(1 / 1.4));
    byId("fit").addEventListener("click", () => this.camera.showAll());
  }

  /** {key: what it does}. */
  get keys() {
    const { camera } = this;
    return { "+": () => camera.zoom(1.4), "-": () => camera.zoom(1 / 1.4), "0": () => camera.showAll() };
  }

  /** Whether a layer is to be chosen from. */
  offer(name, there) {
    this._boxes[name].hidden = !there;
  }

  draw(scene) {
    if (this.camera.fitted) this.camera.fit(scene.bounds);
    const { context, ratio } = sized(this._canvas);
    if (this.show.walls && scene.walls) drawPicture(context, this.camera, scene.walls, ratio);
    this._drawMaps(context, ratio, scene);
    if (this.show.paths) this._trails.draw(context, ratio, this, scene);
    drawMerges(context, this, scene);
    for (const [name, draw] of Object.entries(OVER_MAPS)) if (this.show[name]) draw(context, this, scene);
    drawAuctions(context, this, scene);
    drawAuction(context, this, scene);
    drawRobots(context, this, scene);
    if (this.show.names) drawNames(context, this, scene);
    this._drawScale();
  }

  /** All maps on one clear canvas, walls of one over the free space of the others. */
  _drawMaps(context, ratio, scene) {
    const key = `${this.camera.key} ${this.theme.dark} ${scene.mapsKey}`, kept = this._maps;
    if (key !== kept.key) {
      kept.key = key;
      Object.assign(kept.canvas, { width: this._canvas.width, height: this._canvas.height }); // clears it
      const inner = kept.canvas.getContext("2d");
      inner.globalCompositeOperation = this.theme.dark ? "lighten" : "darken";
      for (const picture of scene.maps()) drawPicture(inner, this.camera, picture, ratio);
    }
    blit(context, kept.canvas, 0.88);
  }

  _drawScale() {
    const { scale } = this.camera, bar = byId("scale").firstElementChild;
    const metres = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find((m) => m * scale >= 60) ?? 200;
    bar.style.width = `${metres * scale}px`;
    setText(bar, `${metres} m`);
  }
}
