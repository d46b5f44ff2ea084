// Elements that several parts of a page are made of.

import { make } from "./dom.js";

/** Puts lists of elements in place only when `key` is another. */
export class Filled {
  constructor(element) {
    this._element = element;
    this._key = "";
  }

  fill(key, elements) {
    const text = JSON.stringify(key);
    if (text === this._key) return;
    this._key = text;
    this._element.replaceChildren(...elements());
  }
}

export function swatch(theme, index) {
  const element = make("span", undefined, "swatch");
  element.style.background = theme.colour(Math.max(0, index));
  return element;
}
