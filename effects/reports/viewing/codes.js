// Pictures as codes, and what is computed from them: differences, their numbers, exposure, false color.
//
// A picture is {width, height, canvas, data, codes, full}: `data` are RGBA bytes, top row first, and `codes`
// the machine's own numbers from 0 to `full` (255, or 4095 where there are 12 bits), alpha a byte. A rectangle
// of it is {x, y, width, height}.

// Component i of a and j of b, a - b, 1 = full.
function delta(a, i, b, j) {
  return a.full === b.full ? (a.codes[i] - b.codes[j]) / a.full : a.codes[i] / a.full - b.codes[j] / b.full;
}

const wholeOf = (picture) => ({ x: 0, y: 0, width: picture.width, height: picture.height });

// Calls each(i, j, n) for the pixels of two rectangles of one size: i of a, j of b, n from 0, first components.
function eachPixel(a, from, b, of, each) {
  let n = 0;
  for (let y = 0; y < from.height; y++) {
    let i = 4 * ((from.y + y) * a.width + from.x), j = 4 * ((of.y + y) * b.width + of.x);
    for (let x = 0; x < from.width; x++, i += 4, j += 4) each(i, j, n++);
  }
}

// {max, at: [x, y], pixels, rms, identical} of a - b: the largest component and where it is first, in a's
// pixels, how many pixels differ, and the root mean square. Where b's alpha is 0 nothing is compared.
function differenceOf(a, b, from = wholeOf(a), of = wholeOf(b)) {
  let max = 0, place = 0, pixels = 0, squares = 0, compared = 0;
  eachPixel(a, from, b, of, (i, j, n) => {
    if (!b.data[j + 3] || !a.data[i + 3]) return;
    let differs = 0;
    for (let c = 0; c < 3; c++) {
      const d = Math.abs(delta(a, i + c, b, j + c));
      squares += d * d;
      if (d > differs) differs = d;
    }
    compared++;
    if (differs) pixels++;
    if (differs > max) [max, place] = [differs, n];
  });
  const rms = compared ? Math.sqrt(squares / (3 * compared)) : 0;
  const at = [from.x + (place % from.width), from.y + Math.floor(place / from.width)];
  return { max, at, pixels, rms, identical: !pixels };
}

// The largest power of two, 1 to 128, with which the largest difference is at most half of full.
const gainFor = (max) => (max ? clamped(2 ** Math.floor(Math.log2(0.5 / max)), 1, 128) : 1);

// From nothing to all: colors whose lightness grows.
const RAMP = [[8, 8, 12], [72, 20, 104], [166, 44, 96], [229, 92, 48], [251, 180, 60], [252, 250, 210]];

function rampColor(value) {
  const place = Math.min(1, value) * (RAMP.length - 1);
  const low = Math.min(RAMP.length - 2, Math.floor(place));
  return RAMP[low].map((from, c) => Math.round(from + (RAMP[low + 1][c] - from) * (place - low)));
}
const ramp256 = () => Array.from({ length: 256 }, (_, i) => rampColor(i / 255));

const MODES = {
  signed: "signed",
  absolute: "absolute",
  color: "false color",
};

// (a - b) x gain made visible, transparent where one of them has no picture.
function differenceCanvas(a, b, gain, mode, from = wholeOf(a), of = wholeOf(b)) {
  const { canvas, context } = newCanvas(from.width, from.height);
  const image = context.createImageData(from.width, from.height), out = image.data, ramp = ramp256();
  eachPixel(a, from, b, of, (i, j, n) => {
    const d = [0, 1, 2].map((c) => 255 * gain * delta(a, i + c, b, j + c));
    const [red, green, blue] =
      mode === "color" ? ramp[Math.min(255, Math.floor(Math.max(...d.map(Math.abs)) + 0.5))]
      : d.map((v) => Math.floor((mode === "signed" ? 128 + v : Math.abs(v)) + 0.5));
    out[4 * n] = red; // a Uint8ClampedArray clamps
    out[4 * n + 1] = green;
    out[4 * n + 2] = blue;
    out[4 * n + 3] = Math.min(a.data[i + 3], b.data[j + 3]);
  });
  context.putImageData(image, 0, 0);
  return canvas;
}

// Source: luminance of ITU-R BT.709, of the codes as they are.
const LUMINANCE = [0.2126, 0.7152, 0.0722];

// A picture times 2 ** stops, clamped; or where `isFalse` its luminance, times that, as colors of the ramp.
function tonedCanvas(picture, stops, isFalse) {
  if (!stops && !isFalse) return picture.canvas;
  const { width, height, codes, full, data } = picture, by = 2 ** stops;
  const { canvas, context } = newCanvas(width, height);
  const image = context.createImageData(width, height), out = image.data, ramp = ramp256();
  for (let p = 0; p < out.length; p += 4) {
    if (isFalse) {
      const light = LUMINANCE.reduce((sum, weight, c) => sum + weight * codes[p + c], 0) / full;
      [out[p], out[p + 1], out[p + 2]] = ramp[Math.min(255, Math.floor(255 * light * by + 0.5))];
    } else for (let c = 0; c < 3; c++) out[p + c] = Math.floor((255 * by * codes[p + c]) / full + 0.5);
    out[p + 3] = data[p + 3];
  }
  context.putImageData(image, 0, 0);
  return canvas;
}
