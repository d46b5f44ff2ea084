// What can be asked of robots, and why not at the moment.

import { byId, button, make, setText } from "./dom.js";
import { LimitForm } from "./limits.js";

const ended = ({ state }) => (state?.state === "finished" ? "has come to rest already" : "");
const waitsForStart = ({ state }) => !state || state.state === "starting";
const atHome = ({ state }) => state?.state === "finished" && state.text?.endsWith("at home");

/** What holds a robot until it is resumed, in words; empty for nothing. */
function hold({ decision, state }) {
  return decision?.paused ? "is paused" : /^is (paused|called back)/.exec(state?.text ?? "")?.[0] ?? "";
}

const ORDERS = { // name: label, hint, and why a robot (its values) cannot do it now; empty: it can
  start: { text: "Start", hint: "Begin to explore", not: (v) => (waitsForStart(v) ? "" : ended(v) || "has begun already") },
  pause: {
    text: "Pause", hint: "Stand still until resumed",
    not: (v) => (hold(v) === "is paused" ? "is paused already" : ended(v)),
  },
  resume: { text: "Resume", hint: "Go on", not: (v) => (hold(v) ? "" : "is not paused") },
  return_now: {
    text: "Return now", hint: "Drive to the start at once and wait there until resumed",
    not: (v) => (hold(v) === "is called back" ? "is called back already" : v.state?.finished ? "has ended its exploration" : ended(v)),
  },
  stop: { text: "Stop", hint: "End the exploration where the robot is", not: ended },
  go_home: {
    text: "Send home", hint: "End the exploration and drive to the start",
    not: (v) => (v.state?.state === "returning" && !hold(v) ? "is on its way home" : atHome(v) ? "is at home" : ""),
  },
};
const RADIO = {
  radio_off: {
    text: "Radio off", hint: "Kill the radio of a simulated robot",
    not: (v) => (v.radio_off ? "has no radio already" : ""),
  },
  radio_on: { text: "Radio on", hint: "Repair it", not: (v) => (v.radio_off ? "" : "has its radio") },
};
const LIMITS = {
  set_limits: { text: "Set limits", hint: "End the exploration after this time or way; empty: no limit", not: ended },
};
const BUTTONS = { ...ORDERS, ...RADIO };
const COMMANDS = { ...BUTTONS, ...LIMITS };
const TEAM = "team_"; // before the name of an order to all that a robot's radio reaches
const PASS_ON = "pass_on_"; // before the name of one to a single robot that it reaches

/** Why a robot cannot be asked for an order, in words; empty if it can. `way`: TEAM, PASS_ON (to the robot `to`) or nothing. */
export function whyNot(robot, order, way = "", to = "") {
  const { values, name } = robot;
  if (values.lost) return `there is no news of ${name}`;
  if (order in RADIO) {
    const why = values.switchable ? RADIO[order].not(values) : "has no simulated radio";
    return why && `${name} ${why}`;
  }
  if (!values.services?.[way + order]) return `${name} offers no service ${SERVICES[way](order)}`;
  if (way === TEAM) return "";
  const why = way === PASS_ON ? whyNotHeard(values.team?.robots[to], order) : COMMANDS[order].not(values);
  return why && `${to || name} ${why}`;
}

const SERVICES = {
  "": (order) => `explorer/${order}`, [TEAM]: (order) => `mission_control/${order}`, [PASS_ON]: () => "mission_control/order",
};

/** The same of one that has told how it is over the radio; an order to hold may still be on its way to it. */
function whyNotHeard(heard, order) {
  return heard?.state && order !== "resume" ? COMMANDS[order].not({ state: heard }) : "";
}

/** Whether a robot can pass orders on to the others. */
const controls = ({ values }) => Object.keys(ORDERS).some((order) => values.services?.[TEAM + order]);

/** Whom buttons can be for: [{key, text, group, robots, way, to}], see whyNot. */
function addressees(robots) {
  const bodies = robots.filter((robot) => robot.hasBody), found = bodies.length > 1 ? [{ key: "", text: "all robots", robots: bodies }] : [];
  found.push(...bodies.map((robot) => ({ key: robot.name, text: robot.name, robots: [robot] })));
  return [...found.map((one) => ({ ...one, group: "", way: "", to: "" })), ...robots.filter(controls).flatMap(passing)];
}

/** Those to whom a robot passes orders on. */
function passing(robot) {
  const shared = { group: `by the radio of ${robot.name}`, robots: [robot] };
  const others = Object.keys(robot.values.team?.robots ?? {});
  return [
    { ...shared, key: `${TEAM}${robot.name}`, text: `all that ${robot.name} reaches`, way: TEAM, to: "" },
    ...others.map((to) => ({ ...shared, key: `${PASS_ON}${robot.name} ${to}`, text: to, way: PASS_ON, to })),
  ];
}

export class CommandBar {
  /** `order(robot, command, to, limits)` sends one, and says whether it was sent. */
  constructor(order) {
    this._order = order;
    this._unanswered = ""; // label of what was sent last, until there is an answer
    this._addressees = [];
    this._select = make("select");
    this._select.title = "Whom the buttons are for";
    this._select.addEventListener("change", () => this._show());
    this._buttons = {};
    byId("commands").append(this._select);
    for (const name of Object.keys(BUTTONS)) byId("commands").append(this._button(name, () => this._press(name)));
    this._limits = new LimitForm(this._button("set_limits", () => this._press("set_limits", this._limits.given)));
  }

  _button(name, pressed) {
    const made = (this._buttons[name] = button(COMMANDS[name].text, COMMANDS[name].hint, pressed));
    made.id = `command-${name}`;
    return made;
  }

  /** The robots that there are now. */
  fill(robots) {
    this._simulated = robots.some(({ values }) => values.switchable);
    this._addressees = addressees(robots.filter((robot) => robot.told));
    this._fillSelect();
    this._show();
  }

  /** For the robot with this name, if need be by the radio of another one; empty: for all. */
  choose(name) {
    const found = this._addressees.find(({ key }) => key === name) ?? this._addressees.find(({ to }) => to && to === name);
    if (!found) return;
    this._select.value = found.key;
    this._show();
  }

  answered({ robot, command, done, text }) {
    this._unanswered = "";
    if (command.endsWith("set_limits") && done) this._limits.taken();
    this._say(`${robot}: ${text || (done ? "done" : `${command} was refused`)}`, done);
  }

  _show() {
    for (const [name, element] of Object.entries(this._buttons)) {
      const reasons = this._reasons(name), able = reasons.includes("");
      element.hidden = name in RADIO && !this._simulated;
      element.setAttribute("aria-disabled", String(!able));
      element.title = able ? COMMANDS[name].hint : reasons[0] ?? "there is no robot";
    }
    const { key, robots, way } = this._chosen();
    this._limits.fill(way ? [] : robots, key);
  }

  _press(name, limits) {
    const reasons = this._reasons(name), { robots, way, to } = this._chosen(), able = robots.filter((_, i) => !reasons[i]);
    if (!able.length) return this._say(this._buttons[name].title, false);
    this._say(`${COMMANDS[name].text}: ${to || able.map((robot) => robot.name).join(", ")} …`, true);
    const sent = able.map((robot) => this._order(robot.name, name in RADIO ? name : way + name, to, limits));
    if (sent.every(Boolean)) this._unanswered = COMMANDS[name].text;
    else this._say(`no connection: ${COMMANDS[name].text} was not sent`, false);
  }

  /** The connection is lost. */
  lost() {
    if (this._unanswered) this._say(`no connection: ${this._unanswered} may not have arrived`, false);
    this._unanswered = "";
  }

  /** Why each of those addressed cannot do it; empty where it can. */
  _reasons(name) {
    const { robots, way, to } = this._chosen();
    const several = name in RADIO && (way || robots.length !== 1);
    return robots.map((robot) => (several ? "choose a robot first" : whyNot(robot, name, way, to)));
  }

  _say(text, good) {
    setText(byId("answer"), text);
    byId("answer").classList.toggle("wrong", !good);
  }

  _chosen() {
    return this._addressees.find(({ key }) => key === this._select.value) ?? { key: "", robots: [], way: "", to: "" };
  }

  _fillSelect() {
    const key = JSON.stringify(this._addressees.map((one) => one.key)), before = this._select.value;
    if (key === this._key) return;
    this._key = key;
    const labels = [...new Set(this._addressees.map(({ group }) => group))];
    this._select.replaceChildren(...labels.flatMap((label) => {
      const options = this._addressees.filter(({ group }) => group === label).map((one) => new Option(one.text, one.key));
      if (!label) return options;
      const group = Object.assign(make("optgroup"), { label });
      group.append(...options);
      return [group];
    }));
    this._select.hidden = this._addressees.length < 2;
    if (this._addressees.some((one) => one.key === before)) this._select.value = before;
  }
}
