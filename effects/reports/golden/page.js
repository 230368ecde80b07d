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

// The bytes of a picture that was written as differences: from those of `other`, or from bytes of its own that come
// `back` before.
async function bytesOf(picture, other) {
  const deflated = Uint8Array.from(atob(picture.data), (c) => c.charCodeAt(0));
  const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  if (picture.of_golden) for (let k = 0; k < bytes.length; k++) bytes[k] += other[k];
  else if (picture.back) for (let k = picture.back; k < bytes.length; k++) bytes[k] += bytes[k - picture.back];
  return bytes;
}

// The codes of an entry's pictures, golden and now: a Uint8Array or Uint16Array, row by row from the top, or null.
async function codesOf(entry) {
  if (!kept.has(entry)) {
    kept.clear(); // one entry's: a page of large pictures would fill the memory
    const golden = entry.golden && await bytesOf(entry.golden), now = entry.now && await bytesOf(entry.now, golden);
    const codes = (picture, bytes) => {
      if (!picture || picture.bits === 8) return bytes;
      const view = new DataView(bytes.buffer);
      return Uint16Array.from({ length: bytes.length / 2 }, (_, k) => view.getUint16(2 * k, true));
    };
    kept.set(entry, [codes(entry.golden, golden), codes(entry.now, now)]);
  }
  return kept.get(entry);
}

const at = (picture, codes, x, y) => Array.from(codes.subarray(
  (y * picture.width + x) * picture.components, (y * picture.width + x + 1) * picture.components));

// An opaque picture of as many pixels: paint(bytes, first byte of a pixel, first code of a pixel) sets three bytes.
function canvasOf({ width, height, components }, paint) {
  const canvas = el("canvas", { width, height });
  const context = canvas.getContext("2d"), image = context.createImageData(width, height), bytes = image.data;
  for (let to = 0, from = 0; to < bytes.length; to += 4, from += components) {
    paint(bytes, to, from);
    bytes[to + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

// Which of a pixel's components are shown as red, green and blue: the colour, or with `alpha` the alpha as a grey.
function channels(n, alpha) {
  if (alpha && n % 2 === 0) return [n - 1, n - 1, n - 1];
  return n < 3 ? [0, 0, 0] : [0, 1, 2];
}

// ------------------------------------------------------------------------------------------------ the stage

const comparable = (a, b) => a && b && a.width === b.width && a.height === b.height &&
  a.components === b.components && a.bits === b.bits;
const ORANGE = [255, 170, 40]; // alpha alone

function drawn(entry, golden, now) {
  const a = entry.golden, b = entry.now, n = b.components;
  const one = (picture, codes) => {
    const [r, g, blue] = channels(picture.components, state.alpha), shift = picture.bits - 8;
    return canvasOf(picture, (bytes, to, from) => {
      bytes[to] = codes[from + r] >> shift;
      bytes[to + 1] = codes[from + g] >> shift;
      bytes[to + 2] = codes[from + blue] >> shift;
    });
  };
  const full = b.bits === 16 ? 65535 : 255, shift = b.bits - 8;
  const gain = state.gain || Math.max(1, Math.floor(full / Math.max(1, entry.difference ? entry.difference.largest : 1)));
  const colors = n % 2 ? n : n - 1; // components that are none of alpha
  const sameColor = (from) => {
    for (let k = from; k < from + colors; k++) if (golden[k] !== now[k]) return false;
    return true;
  };
  const alphaAlone = (from) => n > colors && golden[from + colors] !== now[from + colors] && sameColor(from);
  const gained = (k) => Math.min(full, Math.abs(golden[k] - now[k]) * gain) >> shift;
  const shown = channels(n, state.alpha);
  return {
    gain,
    golden: () => one(a, golden),
    now: () => one(b, now),
    difference: () => canvasOf(b, (bytes, to, from) => {
      if (!state.alpha && alphaAlone(from)) {
        for (let k = 0; k < 3; k++) bytes[to + k] = ORANGE[k] * gained(from + colors) / 255;
      } else {
        for (let k = 0; k < 3; k++) bytes[to + k] = gained(from + shown[k]);
      }
    }),
    mask: () => canvasOf(b, (bytes, to, from) => {
      const color = alphaAlone(from) ? ORANGE : sameColor(from) ? [24, 26, 30] : [255, 255, 255];
      for (let k = 0; k < 3; k++) bytes[to + k] = color[k];
    }),
  };
}

// How much larger pictures are shown: as asked, or so that the largest of them fits.
function zoomOf(entry, room) {
  if (state.zoom) return state.zoom;
  const most = (edge) => Math.max(entry.now[edge], entry.golden ? entry.golden[edge] : 0);
  return Math.max(1, Math.min(16, Math.floor(Math.min(room / most("width"), 480 / most("height")))));
}

async function stage(entry, place, under) {
  const [golden, now] = await codesOf(entry);
  if (pictures[state.index] !== entry) return;
  const both = comparable(entry.golden, entry.now), makes = drawn(entry, golden, now);
  const view = entry.golden ? (both || state.view === "golden" || state.view === "now" ? state.view : "beside") : "now";
  const zoom = zoomOf(entry, (place.clientWidth - 60) / (view === "beside" ? (both ? 3 : 2) : 1));

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

  const alone = entry.now.components % 2 || state.alpha ? "" : "; orange: of alpha alone";
  const titles = { golden: "golden", now: "now", difference: `difference \u00d7 ${makes.gain}${alone}`,
    mask: "mask: white where colours differ, orange where alpha alone does" };
  let content;
  if (view === "beside") {
    content = [figure("golden", sized(makes.golden())), figure("now", sized(makes.now()))];
    if (both) content.push(figure(titles.difference, sized(makes.difference())));
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
    content = [figure(titles[view], sized(makes[view]()))];
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
    list.append(el("h2", { class: title }, `${count} ${words[title][count === 1 ? 0 : 1]}`));
  }
  const apart = entry.difference;
  const small = apart ? `${apart.count} pixel${apart.count === 1 ? "" : "s"}, at most ${apart.largest}` : (entry.told || "").split("\n")[0];
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
