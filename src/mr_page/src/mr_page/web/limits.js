// What ends the exploration of robots though something is left: how much of it is left, and other limits.

import { byId, clock, make, setText } from "./dom.js";

const KINDS = [["time", "s"], ["way", "m"]];

/** [s, m] that a robot has left, null for each without a limit. */
function left({ values: { decision, state } }) {
  const used = [state?.time ?? 0, decision?.way ?? 0];
  return (decision?.limits ?? [0, 0]).map((limit, i) => (limit ? Math.max(0, limit - used[i]) : null));
}

/** In words, the least that any of these robots has left; empty where none has a limit. */
function leftInWords(robots) {
  const least = [0, 1].map((i) => Math.min(...robots.map((robot) => left(robot)[i] ?? Infinity)));
  const told = [clock, (way) => `${way.toFixed(0)} m`].flatMap((inWords, i) => (least[i] < Infinity ? [inWords(least[i])] : []));
  return told.length ? `${told.join(", ")} left` : "";
}

/** The limit of that number if all these robots have the same, as a text; empty for none. */
function common(robots, i) {
  const limits = new Set(robots.map(({ values }) => values.decision?.limits?.[i] ?? 0));
  return limits.size === 1 ? String([...limits][0] || "") : "";
}

export class LimitForm {
  /** `button` sends what is given. */
  constructor(button) {
    this._boxes = KINDS.map(([name, unit]) => {
      const box = Object.assign(make("input"), { type: "number", min: 0, step: "any", placeholder: "none", id: `limit-${name}` });
      const label = make("label", `${name} `);
      label.append(box, ` ${unit}`);
      byId("limits").append(label);
      return box;
    });
    this._left = make("span", "", "hint");
    this._left.id = "left";
    byId("limits").prepend(make("span", "Limits:", "hint"));
    byId("limits").append(button, this._left);
    byId("limits").addEventListener("input", () => { this._written = true; });
    byId("limits").addEventListener("keydown", ({ key, target }) => { if (key === "Enter" && target !== button) button.click(); });
  }

  /** [s, m], 0: none. */
  get given() {
    return this._boxes.map(({ value }) => Number(value) || 0);
  }

  /** What was written has come into force. */
  taken() {
    this._written = false;
  }

  /** With the limits of those robots, unless somebody writes others. `key`: whom the buttons are for. */
  fill(robots, key) {
    if (key !== this._key) this._written = false;
    this._key = key;
    if (!this._written) {
      this._boxes.forEach((box, i) => {
        const text = common(robots, i);
        if (box.value !== text) box.value = text;
      });
    }
    setText(this._left, leftInWords(robots.filter(({ values }) => !values.state?.finished)));
  }
}
