// One row for each robot.

import { byId, make, setName, setText } from "./dom.js";

export class RobotTable {
  /** `columns`: [{title, hint}] beside the name; `chosen(number)` when somebody clicks a row. */
  constructor(theme, columns, chosen) {
    this._theme = theme;
    this._columns = columns;
    this._chosen = chosen;
    this._rows = [];
    const head = byId("robothead");
    head.append(make("th", "Robot"), ...columns.map(({ title, hint }) => Object.assign(make("th", title), { title: hint ?? "" })));
  }

  /** `robots`: [{name, texts: [one for each column], hint, pale}]; `view`: number of the one that is looked at. */
  fill(robots, view) {
    while (this._rows.length < robots.length) this._add();
    while (this._rows.length > robots.length) this._rows.pop().row.remove();
    robots.forEach((robot, index) => {
      const { row, name, swatch, cells } = this._rows[index];
      setText(name, robot.name);
      robot.texts.forEach((text, i) => setText(cells[i], text));
      setName(row, `${view === index ? "chosen" : ""} ${robot.pale ? "silent" : ""}`.trim());
      row.title = robot.hint;
      swatch.style.background = this._theme.colour(index);
    });
  }

  _add() {
    const index = this._rows.length, row = make("tr"), first = make("td");
    const swatch = make("span", undefined, "swatch"), name = make("span");
    first.append(swatch, name);
    const cells = this._columns.map(() => make("td", "–"));
    row.append(first, ...cells);
    row.addEventListener("click", () => this._chosen(index));
    byId("robots").append(row);
    this._rows.push({ row, name, swatch, cells });
  }
}
