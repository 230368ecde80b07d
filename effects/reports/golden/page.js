// Golden pictures: a list, and of the chosen one what is golden, what was drawn, and where they part.

const { says, words, pictures } = JSON.parse(document.getElementById("data").textContent);
const main = document.getElementById("main");
const LETTERS = ["", "L", "LA", "RGB", "RGBA"]; // of a picture's components, by how many there are
const VIEWS = [
  ["beside", "side by side", "1"], ["golden", "golden", "2"], ["now", "now", "3"], ["difference", "difference", "4"],
  ["mask", "mask", "5"], ["flip", "flip", "6"], ["slide", "slide", "7"],
];
const state = { index: -1, view: "beside", zoom: 0, alpha: false, slide: 0.5, flipped: false, gain: 0 };

function el(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null) made.setAttribute(key, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

// ------------------------------------------------------------------------------------------------ pixels

const kept = new Map();

// The codes of a picture: a Uint8Array or Uint16Array, row by row from the top.
async function codesOf(picture) {
  if (!picture) return null;
  if (kept.has(picture)) return kept.get(picture);
  const deflated = Uint8Array.from(atob(picture.data), (c) => c.charCodeAt(0));
  const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = await new Response(stream).arrayBuffer();
  let codes = new Uint8Array(bytes);
  if (picture.bits === 16) {
    const view = new DataView(bytes);
    codes = Uint16Array.from({ length: bytes.byteLength / 2 }, (_, k) => view.getUint16(2 * k, true));
  }
  kept.set(picture, codes);
  return codes;
}

const at = (picture, codes, x, y) => Array.from(codes.subarray(
  (y * picture.width + x) * picture.components, (y * picture.width + x + 1) * picture.components));

// Opaque bytes of a pixel's codes: the colour, or with `alpha` the alpha as a grey.
function shown(picture, code, alpha) {
  const bytes = picture.bits === 16 ? code.map((c) => c >> 8) : code;
  const n = picture.components;
  if (alpha && n % 2 === 0) return [bytes[n - 1], bytes[n - 1], bytes[n - 1]];
  return n < 3 ? [bytes[0], bytes[0], bytes[0]] : bytes.slice(0, 3);
}

function canvasOf(width, height, pixel) {
  const canvas = el("canvas", { width, height });
  const context = canvas.getContext("2d"), image = context.createImageData(width, height);
  for (let y = 0, k = 0; y < height; y++) {
    for (let x = 0; x < width; x++, k += 4) {
      const [r, g, b] = pixel(x, y);
      image.data[k] = r; image.data[k + 1] = g; image.data[k + 2] = b; image.data[k + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

// ------------------------------------------------------------------------------------------------ the stage

const comparable = (a, b) => a && b && a.width === b.width && a.height === b.height &&
  a.components === b.components && a.bits === b.bits;

function drawn(entry, golden, now) {
  const a = entry.golden, b = entry.now;
  const one = (picture, codes) => canvasOf(picture.width, picture.height,
    (x, y) => shown(picture, at(picture, codes, x, y), state.alpha));
  const apart = (x, y) => {
    const first = at(a, golden, x, y), second = at(b, now, x, y);
    return first.map((code, k) => Math.abs(code - second[k]));
  };
  const full = b && b.bits === 16 ? 65535 : 255;
  const gain = state.gain || Math.max(1, Math.floor(full / Math.max(1, entry.difference ? entry.difference.largest : 1)));
  return {
    gain,
    golden: () => one(a, golden),
    now: () => one(b, now),
    difference: () => canvasOf(b.width, b.height, (x, y) => {
      const gained = apart(x, y).map((d) => Math.min(full, d * gain));
      return shown(b, gained, state.alpha);
    }),
    mask: () => canvasOf(b.width, b.height, (x, y) => {
      const differences = apart(x, y), n = differences.length;
      const color = n % 2 === 0 ? differences.slice(0, -1) : differences;
      if (color.some((d) => d)) return [255, 255, 255];
      return differences.some((d) => d) ? [255, 170, 40] : [24, 26, 30]; // alpha alone
    }),
  };
}

function zoomOf(picture, room) {
  if (state.zoom) return state.zoom;
  return Math.max(1, Math.min(16, Math.floor(Math.min(room / picture.width, 480 / picture.height))));
}

async function stage(entry, place, under) {
  const [golden, now] = await Promise.all([codesOf(entry.golden), codesOf(entry.now)]);
  if (pictures[state.index] !== entry) return;
  const both = comparable(entry.golden, entry.now), makes = drawn(entry, golden, now);
  const view = entry.golden ? (both || state.view === "golden" || state.view === "now" ? state.view : "beside") : "now";
  const zoom = zoomOf(entry.now, (place.clientWidth - 60) / (view === "beside" ? (both ? 3 : 2) : 1));

  const sized = (canvas) => {
    canvas.style.width = `${canvas.width * zoom}px`;
    canvas.style.height = `${canvas.height * zoom}px`;
    canvas.addEventListener("pointermove", (event) => tell(event, canvas));
    return canvas;
  };
  const figure = (title, ...canvases) => el("figure", {}, el("figcaption", {}, title), ...canvases);
  const tell = (event, canvas) => {
    const box = canvas.getBoundingClientRect();
    const x = Math.floor((event.clientX - box.left) / zoom), y = Math.floor((event.clientY - box.top) / zoom);
    const line = (title, picture, codes) => {
      if (!picture || x >= picture.width || y >= picture.height || x < 0 || y < 0) return `${title}  outside`;
      const letters = LETTERS[picture.components];
      return `${title}  ${at(picture, codes, x, y).map((code, k) => `${letters[k]} ${code}`).join("  ")}`;
    };
    under.textContent = [`x ${x}, y ${y}`, line("golden", entry.golden, golden), line("now   ", entry.now, now)].join("\n");
  };

  let content;
  if (view === "beside") {
    content = [figure("golden", sized(makes.golden())), figure("now", sized(makes.now()))];
    if (both) content.push(figure(`difference \u00d7 ${makes.gain}`, sized(makes.difference())));
  } else if (view === "flip") {
    const first = sized(makes.golden()), second = sized(makes.now());
    const title = el("figcaption", {}, state.flipped ? "now" : "golden");
    second.style.visibility = state.flipped ? "visible" : "hidden";
    const turn = () => {
      state.flipped = !state.flipped;
      second.style.visibility = state.flipped ? "visible" : "hidden";
      title.textContent = state.flipped ? "now" : "golden";
    };
    content = [el("figure", {}, title, el("div", { class: "over", onclick: turn }, first, second),
      el("p", { class: "quiet" }, "click, or the space bar, flips"))];
    place.flip = turn;
  } else if (view === "slide") {
    const first = sized(makes.golden()), second = sized(makes.now());
    const cut = () => { second.style.clipPath = `inset(0 0 0 ${100 * state.slide}%)`; };
    cut();
    const slider = el("input", { type: "range", min: 0, max: 1000, value: 1000 * state.slide,
      "aria-label": "golden on the left, now on the right", style: `width:${entry.now.width * zoom}px`,
      oninput: (event) => { state.slide = event.target.value / 1000; cut(); } });
    content = [el("figure", {}, el("figcaption", {}, "golden on the left, now on the right"),
      el("div", { class: "over" }, first, second), slider)];
  } else {
    const title = { golden: "golden", now: "now", difference: `difference \u00d7 ${makes.gain}`,
      mask: "mask: white where colours differ, orange where alpha alone does" }[view];
    content = [figure(title, sized(makes[view]()))];
  }
  place.replaceChildren(el("div", { class: "pair" }, content));
  place.dataset.view = view;
}

// ------------------------------------------------------------------------------------------------ the page

const list = el("nav", { "aria-label": "pictures" }), article = el("article", { "aria-live": "polite" });
main.append(list, article);

function toggle(label, pressed, act, key, disabled = false) {
  return el("button", { type: "button", "aria-pressed": String(pressed), disabled, title: key ? `key ${key}` : "",
    onclick: act }, label);
}

function change(changes) { Object.assign(state, changes); show(); }

function show() {
  for (const button of list.querySelectorAll("button")) {
    button.setAttribute("aria-current", String(Number(button.dataset.index) === state.index));
  }
  const entry = pictures[state.index];
  if (!entry) { article.replaceChildren(el("p", { class: "quiet" }, pictures.length ? "Choose a picture." : says)); return; }
  const children = [el("h2", {}, entry.name), el("p", { class: entry.status }, entry.status)];
  if (entry.told) children.push(el("pre", {}, entry.told));
  if (entry.command) {
    const said = el("span", { class: "quiet", role: "status" });
    children.push(el("p", { class: "command" }, el("code", {}, entry.command),
      el("button", { class: "copy", type: "button", onclick: () => copy(entry.command, said) }, "copy"), said));
  }
  article.replaceChildren(...children);
  if (!entry.now) return;
  const both = comparable(entry.golden, entry.now);
  const lacks = { now: false, golden: !entry.golden, beside: !entry.golden };
  const views = VIEWS.map(([name, label, key]) =>
    toggle(label, state.view === name, () => change({ view: name }), key, lacks[name] ?? !both));
  const zooms = [[0, "fit"], [1, "1:1"], [4, "4"], [8, "8"], [16, "16"]].map(([zoom, label]) =>
    toggle(label, state.zoom === zoom, () => change({ zoom })));
  const gains = [[0, "gain that shows it"], [1, "\u00d7 1"], [16, "\u00d7 16"], [255, "\u00d7 255"]].map(([gain, label]) =>
    toggle(label, state.gain === gain, () => change({ gain })));
  const alpha = entry.now.components % 2 === 0
    ? toggle("alpha", state.alpha, () => change({ alpha: !state.alpha }), "a") : null;
  const place = el("div", { class: "stage", tabindex: "0" }), under = el("div", { class: "under" },
    "The bytes of a pixel are told here, of the one under the pointer.");
  article.append(el("div", { class: "bar" }, views), el("div", { class: "bar" }, "zoom", zooms, both ? gains : [], alpha),
    place, under);
  stage(entry, place, under);
}

// Pages that were opened from a file have no clipboard to write to in some browsers: the text is chosen then.
function copy(text, said) {
  const field = el("textarea", {}, text);
  document.body.append(field);
  field.select();
  const done = document.execCommand("copy");
  field.remove();
  said.textContent = done ? "copied" : "select it, and copy";
}

let title = "";
pictures.forEach((entry, index) => {
  if (entry.status !== title) {
    title = entry.status;
    const count = pictures.filter((other) => other.status === title).length;
    list.append(el("h2", { class: title }, `${count} ${words[title]}`));
  }
  const apart = entry.difference;
  const small = apart ? `${apart.count} pixels, at most ${apart.largest}` : (entry.told || "").split("\n")[0];
  list.append(el("button", { type: "button", "data-index": index, onclick: () => change({ index, flipped: false }) },
    entry.name, small && title !== "passed" ? el("small", {}, small) : null));
});

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "INPUT") return;
  const view = VIEWS.find(([, , key]) => key === event.key);
  const step = { ArrowDown: 1, j: 1, ArrowUp: -1, k: -1 }[event.key];
  if (view) change({ view: view[0] });
  else if (step) change({ index: Math.max(0, Math.min(pictures.length - 1, state.index + step)), flipped: false });
  else if (event.key === "a") change({ alpha: !state.alpha });
  else if (event.key === " " && state.view === "flip") article.querySelector(".stage")?.flip?.();
  else return;
  event.preventDefault();
});
change({ index: pictures.length ? 0 : -1 });
