// Maps of a record: pictures that grow, and films of snapshots.

const OCCUPIED_BELOW = 100, FREE_ABOVE = 230; // gray values in the pictures
const KEPT = 8; // painted frames of a film

export function loadImage(uri) {
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

/** A class picture in colours; what is unknown is clear. */
export function painted(image, { free, wall }) {
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

/** A map that grows: only cells that change are painted. `step`: s between two steps of its growth. */
export class GrowingMap {
  constructor(source, image, step) {
    this.matrix = source.matrix;
    this._robot = source.robot;
    this._step = step;
    Object.assign(this, pixelsOf(image));
    const pixels = this.image.data, cells = [];
    this._classes = new Uint8Array(pixels.length / 4);
    this._since = new Uint16Array(pixels.length / 4);
    for (let i = 0; i < this._classes.length; i++) {
      this._classes[i] = pixels[4 * i] < OCCUPIED_BELOW ? 1 : pixels[4 * i] > FREE_ABOVE ? 2 : 0;
      this._since[i] = pixels[4 * i + 1] * 256 + pixels[4 * i + 2];
      if (this._classes[i]) cells.push(i);
    }
    this._order = Uint32Array.from(cells).sort((a, b) => this._since[a] - this._since[b]);
    this._clear();
  }

  at(time, theme, tinted) {
    const style = `${theme.dark} ${tinted}`;
    if (style !== this._style) {
      this._clear();
      this._style = style;
      this._colours = theme.mapColours(this._robot, tinted);
    }
    const step = Math.floor(time / this._step + 1e-6), { _order: order, _since: since } = this;
    while (this._painted < order.length && since[order[this._painted]] <= step) this._set(order[this._painted++], 255);
    while (this._painted > 0 && since[order[this._painted - 1]] > step) this._set(order[--this._painted], 0);
    if (this._changed) this.context.putImageData(this.image, 0, 0);
    this._changed = false;
    return { canvas: this.canvas, matrix: this.matrix };
  }

  _clear() {
    this.image.data.fill(0);
    this._painted = 0;
    this._style = "";
    this._changed = true;
  }

  _set(cell, alpha) {
    const [r, g, b] = this._classes[cell] === 1 ? this._colours.wall : this._colours.free, pixels = this.image.data;
    pixels[4 * cell] = r;
    pixels[4 * cell + 1] = g;
    pixels[4 * cell + 2] = b;
    pixels[4 * cell + 3] = alpha;
    this._changed = true;
  }
}

/** Snapshots of one robot's global map; coloured when first shown, the last few are kept. */
export class Film {
  constructor(robot, frames, images) {
    this._robot = robot;
    this._frames = frames.map((frame, i) => ({ ...frame, image: images[i] })).filter((frame) => frame.image);
    this._ready = new Map();
  }

  at(time, theme) {
    const index = this._frames.findLastIndex((frame) => frame.time <= time);
    if (index < 0) return null;
    const key = `${index} ${theme.dark}`, frame = this._frames[index];
    if (!this._ready.has(key)) {
      if (this._ready.size > KEPT) this._ready.delete(this._ready.keys().next().value);
      this._ready.set(key, painted(frame.image, theme.mapColours(this._robot, false)));
    }
    return { canvas: this._ready.get(key), matrix: frame.matrix };
  }
}
