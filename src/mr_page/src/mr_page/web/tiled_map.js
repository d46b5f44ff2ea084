// A map that comes in tiles (mr_page.tiles).

const TILE = 64; // cells a side
const MOST_PIXELS = 2048; // a side of the picture; larger maps are painted coarser
const OCCUPIED = 2;
const BLANK = new Uint8Array((TILE * TILE) / 4);

export class TiledMap {
  constructor() {
    this.version = 0; // another one after each change
    this._tiles = new Map();
    this._dirty = new Set();
    this._lattice = null;
    this._canvas = document.createElement("canvas");
    this._frame = null; // {top, left, step} of the picture: tiles above and left of it, cells a pixel
    this._style = "";
  }

  /** All begins anew: m a cell, and the pose of the corner of cell (0, 0). */
  restart(resolution, x, y, yaw) {
    this._lattice = { resolution, x, y, yaw };
    this._tiles.clear();
    this._dirty.clear();
    this._frame = null;
    this.version++;
  }

  set(row, column, octets) {
    const key = `${row} ${column}`;
    this._tiles.set(key, { row, column, octets, box: boxOf(octets) });
    this._dirty.add(key);
    this.version++;
  }

  /** Be the map of these tiles [{row, column, octets}] on a lattice [m a cell, x, y, yaw], undefined: of nothing. */
  become(lattice, tiles) {
    const same = lattice && this._lattice && Object.values(this._lattice).every((value, i) => value === lattice[i]);
    if (!same && lattice) this.restart(...lattice);
    const wanted = new Set(tiles.map(({ row, column }) => `${row} ${column}`));
    for (const [key, { row, column }] of this._tiles) if (!wanted.has(key)) this._setIfOther(row, column, BLANK);
    for (const { row, column, octets } of tiles) this._setIfOther(row, column, octets);
  }

  _setIfOther(row, column, octets) {
    const before = this._tiles.get(`${row} ${column}`)?.octets ?? BLANK;
    if (octets.some((value, i) => value !== before[i])) this.set(row, column, octets);
  }

  /** [left, bottom, right, top] of what is known in m from the lattice's corner, null while nothing is. */
  get box() {
    if (this._boxVersion !== this.version) {
      this._boxVersion = this.version;
      this._box = this._findBox();
    }
    return this._box;
  }

  _findBox() {
    const box = [Infinity, Infinity, -Infinity, -Infinity], { resolution } = this._lattice ?? {};
    for (const tile of this._tiles.values()) {
      if (!tile.box) continue;
      const [left, bottom, right, top] = tile.box, x = tile.column * TILE, y = tile.row * TILE;
      box[0] = Math.min(box[0], resolution * (x + left));
      box[1] = Math.min(box[1], resolution * (y + bottom));
      box[2] = Math.max(box[2], resolution * (x + right));
      box[3] = Math.max(box[3], resolution * (y + top));
    }
    return box[0] < box[2] ? box : null;
  }

  /** The lattice's corner in a frame in which the map's frame lies at `place`. */
  corner(place) {
    const cosine = Math.cos(place.yaw), sine = Math.sin(place.yaw), { x, y, yaw } = this._lattice;
    return { x: place.x + cosine * x - sine * y, y: place.y + sine * x + cosine * y, yaw: place.yaw + yaw };
  }

  /** {canvas, matrix} in colours {free, wall}, with the map's frame at `place`; null while nothing is known. */
  picture(colours, place) {
    if (!this._lattice || !this._tiles.size) return null;
    this._paint(colours);
    const { top, left, step } = this._frame, { resolution } = this._lattice, corner = this.corner(place);
    const cosine = Math.cos(corner.yaw), sine = Math.sin(corner.yaw), size = resolution * step;
    const x = left * TILE * resolution, y = (top + 1) * TILE * resolution;
    return {
      canvas: this._canvas,
      matrix: [
        cosine * size, sine * size, sine * size, -cosine * size,
        corner.x + cosine * x - sine * y, corner.y + sine * x + cosine * y,
      ],
    };
  }

  _paint(colours) {
    const style = JSON.stringify(colours);
    if (!this._fits() || style !== this._style) {
      this._style = style;
      this._frame = this._newFrame();
      const { width, height } = this._frame;
      Object.assign(this._canvas, { width, height }); // clears it
      this._dirty = new Set(this._tiles.keys());
    }
    const context = this._canvas.getContext("2d"), side = TILE / this._frame.step, image = new ImageData(side, side);
    for (const key of this._dirty) {
      const tile = this._tiles.get(key);
      paintTile(image.data, tile.octets, this._frame.step, colours);
      context.putImageData(image, (tile.column - this._frame.left) * side, (this._frame.top - tile.row) * side);
    }
    this._dirty.clear();
  }

  _fits() {
    if (!this._frame) return false;
    const { top, left, bottom, right } = this._frame;
    for (const key of this._dirty) {
      const { row, column } = this._tiles.get(key);
      if (row > top || row < bottom || column < left || column > right) return false;
    }
    return true;
  }

  _newFrame() {
    const tiles = [...this._tiles.values()], rows = tiles.map(({ row }) => row), columns = tiles.map(({ column }) => column);
    const [top, bottom, left, right] = [Math.max(...rows), Math.min(...rows), Math.min(...columns), Math.max(...columns)];
    const longest = TILE * Math.max(top - bottom + 1, right - left + 1);
    const step = [1, 2, 4, 8].find((one) => longest / one <= MOST_PIXELS) ?? 16;
    return {
      top, bottom, left, right, step, width: ((right - left + 1) * TILE) / step, height: ((top - bottom + 1) * TILE) / step,
    };
  }
}

/** [left, bottom, right, top] of the known cells, in cells, rounded to four in a row; null if there are none. */
function boxOf(octets) {
  let left = TILE, bottom = TILE, right = 0, top = 0;
  for (let i = 0; i < octets.length; i++) {
    if (!octets[i]) continue;
    const column = 4 * (i % 16), row = i >> 4;
    left = Math.min(left, column);
    right = Math.max(right, column + 4);
    bottom = Math.min(bottom, row);
    top = row + 1;
  }
  return top ? [left, bottom, right, top] : null;
}

/** Pixels of a tile, the highest row first; a pixel of several cells shows a wall if there is one, else free space. */
function paintTile(pixels, octets, step, { free, wall }) {
  const side = TILE / step;
  for (let y = 0; y < side; y++) {
    for (let x = 0; x < side; x++) {
      const cell = highest(octets, x * step, y * step, step), at = 4 * ((side - 1 - y) * side + x);
      const paint = cell === OCCUPIED ? wall : free;
      pixels[at] = paint[0];
      pixels[at + 1] = paint[1];
      pixels[at + 2] = paint[2];
      pixels[at + 3] = cell ? 255 : 0;
    }
  }
}

function highest(octets, x, y, step) {
  let found = 0;
  for (let row = y; row < y + step; row++) {
    for (let column = x; column < x + step; column++) {
      const cell = (octets[row * 16 + (column >> 2)] >> (2 * (column & 3))) & 3;
      if (cell > found) found = cell;
    }
  }
  return found;
}
