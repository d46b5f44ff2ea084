// The web socket of a page: what the server tells (mr_page.update), and what is asked of it.

const TILE_OCTETS = 1024;
const RETRY = 1500; // ms
const WATCH = 1000; // ms between two looks whether it is alive
const SILENCE = 5000; // ms; the server says something every two seconds

/** {anew, robots, maps, tiles: [{robot, kind, row, column, octets}], rest, moment (of what was)} of a message. */
export function decoded(buffer) {
  const length = new DataView(buffer).getUint32(0);
  const document = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  document.tiles = document.tiles.map(([robot, kind, row, column], i) => ({
    robot, kind, row, column, octets: new Uint8Array(buffer, 4 + length + i * TILE_OCTETS, TILE_OCTETS),
  }));
  return document;
}

export class Connection {
  /** `took(update)`; `tookPast(update)`; `answered({robot, command, to, done, text})`; `changed(connected)`. */
  constructor({ took, tookPast, answered, changed }) {
    this._took = took;
    this._tookPast = tookPast;
    this._answered = answered;
    this._changed = changed;
    this._socket = null;
    this._heardAt = 0;
    this._maps = "[]";
    this._open();
    setInterval(() => this._watch(), WATCH);
  }

  /** The maps that are looked at, [[robot, kind]]. Whether they are others than before. */
  lookAt(maps) {
    const text = JSON.stringify(maps);
    if (text === this._maps) return false;
    this._maps = text;
    this._send(`{"maps":${text}}`);
    return true;
  }

  /** `to`: the robot to which it is to be passed on, empty: to none; `limits`: [s, m] of set_limits. Whether it was sent. */
  order(robot, command, to, limits) {
    return this._send(JSON.stringify({ robot, command, ...(to && { to }), ...(limits && { limits }) }));
  }

  /** What was at a time of the team's clock comes to `tookPast(update)`. */
  askForPast(time) {
    this._send(JSON.stringify({ past: time }));
  }

  _heard(data) {
    this._heardAt = performance.now();
    if (typeof data === "string") {
      this._answered(JSON.parse(data));
      return;
    }
    const update = decoded(data);
    if (update.moment === undefined) this._took(update); else this._tookPast(update);
  }

  _send(text) {
    if (this._socket?.readyState !== WebSocket.OPEN) return false;
    this._socket.send(text);
    return true;
  }

  /** A browser takes minutes to find out that a link is dead. */
  _watch() {
    if (this._socket?.readyState === WebSocket.OPEN && performance.now() - this._heardAt > SILENCE) this._lose();
  }

  _lose() {
    const socket = this._socket;
    this._socket = null;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
    this._changed(false);
    setTimeout(() => this._open(), RETRY);
  }

  _open() {
    const place = window.location, socket = new WebSocket(`${place.protocol === "https:" ? "wss" : "ws"}://${place.host}/live`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this._heardAt = performance.now();
      this._changed(true);
      this._send(`{"maps":${this._maps}}`);
    };
    socket.onmessage = ({ data }) => this._heard(data);
    socket.onclose = () => this._lose();
    this._socket = socket;
  }
}
