// What can be asked of robots, and why not at the moment.

import { byId, button, make, setText } from "./dom.js";

const ended = ({ state }) => (state?.state === "finished" ? "has come to rest already" : "");
const begun = ({ state }) => (state && state.state !== "starting" ? "" : "has not begun");

const COMMANDS = { // name: label, hint, and why a robot (its values) cannot do it now; empty: it can
  start: { text: "Start", hint: "Begin to explore", not: (v) => (begun(v) ? "" : "has begun already") },
  pause: { text: "Pause", hint: "Stand still until resumed", not: (v) => (v.decision?.paused ? "is paused already" : begun(v) || ended(v)) },
  resume: { text: "Resume", hint: "Go on", not: (v) => (v.decision?.paused ? "" : "is not paused") },
  stop: { text: "Stop", hint: "End the exploration where the robot is", not: (v) => begun(v) || ended(v) },
  go_home: { text: "Send home", hint: "End the exploration and drive to the start", not: (v) => begun(v) || (v.state?.state === "returning" ? "is on its way home" : "") },
};
const RADIO = {
  radio_off: { text: "Radio off", hint: "Kill the radio of a simulated robot", not: (v) => (v.radio_off ? "has no radio already" : "") },
  radio_on: { text: "Radio on", hint: "Repair it", not: (v) => (v.radio_off ? "" : "has its radio") },
};

/** Why a robot cannot be asked for it, in words; empty if it can. */
export function whyNot(robot, command) {
  const { values, name } = robot;
  if (!robot.told) return `${name} does not feed this page`;
  if (values.lost) return `there is no news of ${name}`;
  if (command in RADIO) {
    const why = values.switchable ? RADIO[command].not(values) : "has no simulated radio";
    return why && `${name} ${why}`;
  }
  if (!values.services?.[command]) return `${name} offers no service explorer/${command}`;
  const why = COMMANDS[command].not(values);
  return why && `${name} ${why}`;
}

export class CommandBar {
  /** `order(robot, command)` sends one. */
  constructor(order) {
    this._order = order;
    this._robots = [];
    this._select = make("select");
    this._select.title = "Whom the buttons are for";
    this._select.addEventListener("change", () => this.fill(this._robots));
    this._buttons = {};
    byId("commands").append(this._select);
    for (const [name, { text, hint }] of Object.entries({ ...COMMANDS, ...RADIO })) {
      this._buttons[name] = button(text, hint, () => this._press(name));
      this._buttons[name].id = `command-${name}`;
      byId("commands").append(this._buttons[name]);
    }
  }

  /** The robots that there are now. */
  fill(robots) {
    this._robots = robots.filter((robot) => robot.told && robot.hasBody);
    this._fillSelect();
    const simulated = this._robots.some(({ values }) => values.switchable);
    for (const [name, element] of Object.entries(this._buttons)) {
      const reasons = this._reasons(name);
      const able = reasons.some((reason) => !reason);
      element.hidden = name in RADIO && !simulated;
      element.setAttribute("aria-disabled", String(!able));
      element.title = able ? { ...COMMANDS, ...RADIO }[name].hint : reasons[0] ?? "there is no robot";
    }
  }

  /** For the robot with this name; empty: for all. */
  choose(name) {
    if ([...this._select.options].some((option) => option.value === name)) this._select.value = name;
    this.fill(this._robots);
  }

  answered({ robot, command, done, text }) {
    this._say(`${robot}: ${text || (done ? "done" : `${command} was refused`)}`, done);
  }

  _press(name) {
    const reasons = this._reasons(name), able = this._chosen().filter((_, i) => !reasons[i]);
    if (!able.length) return this._say(this._buttons[name].title, false);
    this._say(`${{ ...COMMANDS, ...RADIO }[name].text}: ${able.map((robot) => robot.name).join(", ")} …`, true);
    for (const robot of able) this._order(robot.name, name);
  }

  /** Why each of the chosen robots cannot do it; empty where it can. */
  _reasons(name) {
    const one = this._chosen().length === 1;
    return this._chosen().map((robot) => (name in RADIO && !one ? "choose a robot first" : whyNot(robot, name)));
  }

  _say(text, good) {
    setText(byId("answer"), text);
    byId("answer").classList.toggle("wrong", !good);
  }

  _chosen() {
    return this._select.value ? this._robots.filter((robot) => robot.name === this._select.value) : this._robots;
  }

  _fillSelect() {
    const names = this._robots.map((robot) => robot.name), key = names.join(" ");
    if (key === this._key) return;
    this._key = key;
    const before = this._select.value, all = names.length > 1 ? [new Option("all robots", "")] : [];
    this._select.replaceChildren(...all, ...names.map((name) => new Option(name, name)));
    this._select.hidden = names.length < 2;
    if (names.includes(before)) this._select.value = before;
  }
}
