// What a drag on the picture turns: the light or the camera, by the parameters that say so ("gesture").

const TOOLS = {
  look: { name: "look", key: "q", of: [] },
  camera: { name: "camera", key: "o", of: ["orbit", "eye", "turn", "lean"] },
  light: { name: "light", key: "i", of: ["light", "lamp", "light angle"] },
};
const HALF_TURN = 180; // degrees that a drag across a panel's height turns
const KEY_STEP = 5; // degrees of an arrow key
const HIGHEST = 89; // degrees: an eye does not look along the upright axis

const radians = (degrees) => (degrees * Math.PI) / 180;
const toolsOf = (controls) => Object.keys(TOOLS).filter((tool) => tool === "look" || controls.some((of) => TOOLS[tool].of.includes(of.gesture)));
// What a drag turns where nobody has chosen: a camera that goes around, else the light.
function usualTool(controls) {
  const can = toolsOf(controls), isRound = controls.some((of) => ["orbit", "eye", "turn"].includes(of.gesture));
  return isRound || !can.includes("light") ? can.find((tool) => tool !== "look") || "look" : "light";
}

// A vector turned about the upright axis by `right`, and about the horizontal one by `down`, degrees.
function turned([x, y, z], right, down) {
  const [a, b] = [radians(right), radians(down)];
  const [u, w] = [x * Math.cos(a) + z * Math.sin(a), z * Math.cos(a) - x * Math.sin(a)];
  return [u, y * Math.cos(b) - w * Math.sin(b), y * Math.sin(b) + w * Math.cos(b)];
}
// An eye around a place: the picture follows the hand, so the eye goes the other way.
function orbited(eye, around, right, down) {
  const [x, y, z] = eye.map((c, n) => c - around[n]), far = Math.hypot(x, y, z) || 1;
  const along = Math.atan2(x, z) - radians(right);
  const up = clamped(Math.asin(clamped(y / far, -1, 1)) + radians(down), radians(-HIGHEST), radians(HIGHEST));
  return [far * Math.cos(up) * Math.sin(along), far * Math.sin(up), far * Math.cos(up) * Math.cos(along)].map((c, n) => c + around[n]);
}
// An angle within its kind's bounds: where those hold a whole turn, it goes around.
function withinBounds(value, { least, most }) {
  const [low, high] = [least ?? -Infinity, most ?? Infinity];
  if (high - low < 360) return clamped(value, low, high);
  return value > high ? value - 360 : value < low ? value + 360 : value;
}

// {name: text}: the values after a turn by so many degrees to the right and down; `begin`: those before it.
function afterTurn(controls, tool, begin, right, down) {
  const found = {}, words = (numbers) => numbers.map(inWords).join(",");
  for (const of of controls.filter((one) => TOOLS[tool].of.includes(one.gesture))) {
    const now = numbersIn(begin[of.name]);
    if (now.some((number) => !Number.isFinite(number))) continue;
    const around = begin.target && of.gesture === "eye" ? numbersIn(begin.target) : [0, 0, 0];
    found[of.name] = {
      light: () => words(turned(now, right, down)),
      lamp: () => words(turned(now, right, down)),
      "light angle": () => words([withinBounds(now[0] - right, of.parts[0])]),
      orbit: () => words(orbited(now, [0, 0, 0], right, down)),
      eye: () => words(orbited(now, around, right, down)),
      turn: () => words([withinBounds(now[0] + right, of.parts[0])]),
      lean: () => words([withinBounds(now[0] + down, of.parts[0])]),
    }[of.gesture]();
  }
  return found;
}

// Drags on the stage with a tool. `ask()` gives {tool, begin, high}: begin the values by name, high a panel's
// height in CSS pixels; turn(values, isDone, event); pointed(at, event) for a press that did not move.
function makeGestures(stage, ask, turn, pointed) {
  const { element } = stage;
  let drag = null;
  const isOurs = (event) => event.button === 0 && ask().tool !== "look" && !event.target.closest(".divider");
  element.addEventListener("pointerdown", (event) => {
    if (!isOurs(event) || !stage.pixelAt(event.clientX, event.clientY)) return;
    event.stopImmediatePropagation();
    element.focus({ preventScroll: true });
    element.setPointerCapture(event.pointerId);
    drag = { ...ask(), x: event.clientX, y: event.clientY, moved: false };
  }, { capture: true });
  element.addEventListener("pointermove", (event) => {
    if (!drag) return;
    event.stopImmediatePropagation();
    const [dx, dy] = [event.clientX - drag.x, event.clientY - drag.y];
    drag.moved ||= Math.hypot(dx, dy) > 3;
    if (drag.moved) turn(drag, (dx * HALF_TURN) / drag.high, (dy * HALF_TURN) / drag.high, false, event);
  }, { capture: true });
  element.addEventListener("pointerup", (event) => {
    if (!drag) return;
    event.stopImmediatePropagation();
    if (drag.moved) turn(drag, ((event.clientX - drag.x) * HALF_TURN) / drag.high, ((event.clientY - drag.y) * HALF_TURN) / drag.high, true, event);
    else pointed(stage.pixelAt(event.clientX, event.clientY), event);
    drag = null;
  }, { capture: true });
  element.addEventListener("pointercancel", () => { drag = null; }, { capture: true });
  return {
    // Arrow keys turn as a drag does; returns whether the key was one of these.
    key(event) {
      const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (!by || ask().tool === "look") return false;
      turn(ask(), by[0] * KEY_STEP, by[1] * KEY_STEP, true, event);
      return true;
    },
  };
}
