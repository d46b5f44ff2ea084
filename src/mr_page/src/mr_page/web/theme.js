// Light and dark: colours of the style sheet for the canvases, and those of the robots.

const COLOURS = [ // [light, dark], the order in which robots get them
  ["#d62728", "#ff6b6b"], ["#1f77b4", "#5fb0ee"], ["#2ca02c", "#5fd068"], ["#e07b00", "#ffb14d"],
  ["#8a5cc0", "#bd96ee"], ["#0f9fb3", "#4fd6e6"], ["#8c564b", "#cf9a8c"], ["#d5539f", "#f595cd"],
  ["#6b7a00", "#c3d24a"], ["#2f3fbf", "#8d9bff"], ["#00796b", "#3fc7b4"], ["#a8324a", "#f07f97"],
  ["#5f6b7a", "#aebaca"], ["#b08900", "#f2d14b"], ["#3d7a1e", "#9be06a"], ["#7a1fa2", "#dc8cff"],
];
const NAMES = [
  "page", "panel", "line", "text", "soft", "unknown", "free", "wall", "truth", "accent", "right", "wrong", "revoked",
  "warn", "halo",
];

export class Theme {
  /** `changed()` is called after each change, also of the system's setting, which holds until somebody chooses. */
  constructor(changed) {
    this.dark = false;
    this.css = {};
    this._changed = changed;
    const night = window.matchMedia("(prefers-color-scheme: dark)");
    this._set(night.matches);
    night.addEventListener("change", () => this.apply(night.matches));
  }

  apply(dark) {
    this._set(dark);
    this._changed();
  }

  /** Of a robot by its number. */
  colour(index) {
    return COLOURS[index % COLOURS.length][this.dark ? 1 : 0];
  }

  mergeColour(kind) {
    return this.css[{ right: "right", placed: "right", wrong: "wrong" }[kind] ?? "revoked"];
  }

  /** Colours of free space and walls as [red, green, blue]; free space takes a tint of a robot's colour. */
  mapColours(robot, tinted) {
    const free = rgb(this.css.free), wall = rgb(this.css.wall);
    return { free: tinted ? mixed(free, rgb(this.colour(robot)), this.dark ? 0.22 : 0.17) : free, wall };
  }

  _set(dark) {
    this.dark = dark;
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    const style = getComputedStyle(document.documentElement);
    for (const name of NAMES) this.css[name] = style.getPropertyValue(`--${name}`).trim();
  }
}

/** Red, green and blue of a colour written as #rrggbb. */
export const rgb = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));

const mixed = (a, b, share) => [0, 1, 2].map((i) => Math.round(a[i] + share * (b[i] - a[i])));
