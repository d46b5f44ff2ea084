// Elements, numbers and texts.

export const byId = (id) => document.getElementById(id);

export const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

export function make(tag, text, name) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (name) element.className = name;
  return element;
}

/** Writes only what is another text than before: the browser lays out again whatever is written. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function setName(element, name) {
  if (element.className !== name) element.className = name;
}

/** Seconds as 4:05 or 1:04:05. */
export function clock(seconds) {
  const whole = Math.max(0, Math.floor(seconds + 1e-6));
  const hours = Math.floor(whole / 3600), minutes = Math.floor(whole / 60) % 60;
  const tail = `${String(minutes).padStart(hours ? 2 : 1, "0")}:${String(whole % 60).padStart(2, "0")}`;
  return hours ? `${hours}:${tail}` : tail;
}

export function bytes(n) {
  if (n >= 1e9) return `${(n / 1e9).toFixed(2)} GB`;
  if (n >= 1e6) return `${(n / 1e6).toFixed(1)} MB`;
  return n >= 1e3 ? `${(n / 1e3).toFixed(0)} kB` : `${n} B`;
}

/** Like toFixed, without the sign of what is rounded to zero. */
export function fixed(number, digits) {
  const text = number.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

/** Octets per second as kbit/s, without the unit. */
export function kilobits(n) {
  return (n / 125).toFixed(n < 1250 ? 1 : 0);
}

/** A box with its label that calls `changed(checked)`. */
export function checkBox(text, checked, changed) {
  const box = make("input"), wrap = make("label");
  Object.assign(box, { type: "checkbox", checked });
  box.addEventListener("change", () => changed(box.checked));
  wrap.append(box, text);
  return wrap;
}

export function button(text, hint, pressed) {
  const element = make("button", text);
  Object.assign(element, { type: "button", title: hint });
  element.addEventListener("click", pressed);
  return element;
}
