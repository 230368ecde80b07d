// What the page holds, and what it fetches. A page that was opened from a file may read no other file, but it
// may run scripts: records/ID.js calls record(...), pictures/DIGEST.js calls picture(...).

const INDEX = JSON.parse(document.getElementById("index").textContent);
const FIGURES = new Map(INDEX.figures.map((figure) => [figure.id, figure]));

// An element with its attributes and children. Text only ever becomes text nodes, so it needs no escaping.
function el(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) {
      made.setAttribute(key, value === true ? "" : value);
    }
  }
  made.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
  return made;
}

const nameOf = (machine) => INDEX.machines[machine] || machine;

const arrivals = new Map(); // a script's address -> what to call with what it delivers

function fetched(address, charset) {
  return new Promise((resolve, reject) => {
    arrivals.set(address, resolve);
    const script = el("script", { src: address.split("/").map(encodeURIComponent).join("/"), charset });
    script.onload = script.onerror = () => {
      script.remove();
      arrivals.delete(address);
      reject(new Error(`${address} cannot be read. Draw the figure again.`));
    };
    document.head.append(script);
  });
}

window.record = (record) => arrivals.get(`records/${record.id}.js`)?.(record);
window.picture = (digest, width, height, text, base) =>
  arrivals.get(`pictures/${digest}.js`)?.({ width, height, text, base });

// The last few answers of a slow function, by its argument.
function kept(make, most) {
  const answers = new Map();
  return (key) => {
    const answer = answers.get(key) || make(key);
    answers.delete(key);
    answers.set(key, answer);
    answer.catch(() => answers.delete(key));
    if (answers.size > most) answers.delete(answers.keys().next().value);
    return answer;
  };
}

const recordOf = kept((id) => fetched(`records/${id}.js`, "utf-8"), 40);

// A picture's script is read as windows-1252, in which each byte is one character.
const BYTES = new Map(
  [...new TextDecoder("windows-1252").decode(Uint8Array.from({ length: 256 }, (_, byte) => byte))].map(
    (character, byte) => [character.charCodeAt(0), byte],
  ),
);

function newCanvas(width, height) {
  const canvas = el("canvas", { width, height });
  return { canvas, context: canvas.getContext("2d", { willReadFrequently: true }) };
}

// {width, height, canvas, data: RGBA bytes, top row first}
const bytesOf = kept(async (digest) => {
  const { width, height, text, base } = await fetched(`pictures/${digest}.js`, "windows-1252");
  const file = new Uint8Array(text.length);
  for (let i = 0; i < file.length; i++) file[i] = BYTES.get(text.charCodeAt(i));
  const blob = new Blob([file], { type: "image/webp" });
  const bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const { canvas, context } = newCanvas(width, height);
  context.drawImage(bitmap, 0, 0);
  const shown = context.getImageData(0, 0, width, height);
  if (base) {
    // The file holds what is to be added to the base's bytes, 128 for nothing; all is opaque.
    const { data } = await bytesOf(base);
    for (let i = 0; i < data.length; i++) {
      shown.data[i] = i % 4 === 3 ? 255 : (shown.data[i] + data[i] + 128) & 255;
    }
    context.putImageData(shown, 0, 0);
  }
  return { width, height, canvas, data: shown.data };
}, 24);

// A picture with its codes: RGBA at 4 * (y * width + x), from 0 to `full`; alpha stays a byte.
async function pictureOf({ digest, finer }) {
  const shown = await bytesOf(digest);
  if (!finer) return { ...shown, digest, codes: shown.data, full: 255 };
  const { data } = await bytesOf(finer);
  const codes = Uint16Array.from(shown.data, (byte, i) =>
    i % 4 === 3 ? byte : Math.floor((byte * 4095) / 255 + 0.5) + data[i] - 128,
  );
  return { ...shown, digest, codes, full: 4095 };
}

// Component i of a - b, 1 = full.
function delta(a, b, i) {
  return a.full === b.full ? (a.codes[i] - b.codes[i]) / a.full : a.codes[i] / a.full - b.codes[i] / b.full;
}

// {max, at: [x, y], pixels, rms}: the largest component and where it is first, and how many pixels differ.
function differenceOf(a, b) {
  let max = 0, place = 0, pixels = 0, squares = 0, compared = 0;
  for (let pixel = 0; pixel < a.width * a.height; pixel++) {
    if (!b.data[4 * pixel + 3]) continue;
    let differs = 0;
    for (let i = 4 * pixel; i < 4 * pixel + 3; i++) {
      const d = Math.abs(delta(a, b, i));
      squares += d * d;
      differs = Math.max(differs, d);
    }
    compared++;
    if (differs) pixels++;
    if (differs > max) [max, place] = [differs, pixel];
  }
  const rms = compared ? Math.sqrt(squares / (3 * compared)) : 0;
  return { max, at: [place % a.width, Math.floor(place / a.width)], pixels, rms, identical: !pixels };
}

// From nothing to all: colours whose lightness grows.
const RAMP = [[8, 8, 12], [72, 20, 104], [166, 44, 96], [229, 92, 48], [251, 180, 60], [252, 250, 210]];

function rampColor(value) {
  const place = Math.min(1, value) * (RAMP.length - 1);
  const low = Math.min(RAMP.length - 2, Math.floor(place));
  return RAMP[low].map((from, c) => Math.round(from + (RAMP[low + 1][c] - from) * (place - low)));
}

const MODES = {
  signed: "signed",
  absolute: "absolute",
  color: "false color",
};

// (a - b) x gain made visible, transparent where b has no picture.
function differenceCanvas(a, b, gain, mode) {
  const { canvas, context } = newCanvas(a.width, a.height);
  const image = context.createImageData(a.width, a.height), out = image.data;
  const ramp = Array.from({ length: 256 }, (_, i) => rampColor(i / 255));
  for (let p = 0; p < out.length; p += 4) {
    const d = [0, 1, 2].map((c) => 255 * gain * delta(a, b, p + c));
    const [red, green, blue] =
      mode === "color" ? ramp[Math.min(255, Math.floor(Math.max(...d.map(Math.abs)) + 0.5))]
      : d.map((v) => Math.floor((mode === "signed" ? 128 + v : Math.abs(v)) + 0.5));
    out[p] = red; // a Uint8ClampedArray clamps
    out[p + 1] = green;
    out[p + 2] = blue;
    out[p + 3] = b.data[p + 3];
  }
  context.putImageData(image, 0, 0);
  return canvas;
}
