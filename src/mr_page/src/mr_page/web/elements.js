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

/** `heads`: texts or elements; `rows`: of such cells, – where there is null. */
export function table(heads, rows) {
  const element = make("table"), body = make("tbody"), top = make("thead");
  top.append(row("th", heads));
  body.append(...rows.map((cells) => row("td", cells)));
  element.append(top, body);
  return element;
}

function row(tag, cells) {
  const element = make("tr");
  element.append(...cells.map((cell) => {
    const made = make(tag);
    made.append(cell ?? "–");
    return made;
  }));
  return element;
}

export function swatch(theme, index) {
  const element = make("span", undefined, "swatch");
  element.style.background = theme.colour(Math.max(0, index));
  return element;
}
