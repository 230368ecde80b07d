// The pictures that have come, and what the stage asks of them.

const LAYERS = {
  machine: { name: "machine", key: "1" },
  ideal: { name: "ideal", key: "2" },
  reference: { name: "reference", key: "3" },
  difference: { name: "difference", key: "4", from: "ideal" },
  reference_difference: { name: "from reference", key: "5", from: "reference" },
  other: { name: "B", key: "b" },
  other_difference: { name: "A \u2212 B", key: "6", from: "other" },
};

// A picture of a message, over the one that it is based on. {width, height, canvas, data, codes, full, serial}
function pictureOf(header, bytes, base) {
  const { width, height, bits, box: [x, y, w, h] } = header, full = 2 ** bits - 1;
  const isDeep = bits > 8, codes = isDeep ? new Uint16Array(bytes.buffer, bytes.byteOffset, bytes.length / 2) : bytes;
  const made = base || { width, height, ...newCanvas(width, height) };
  if (!base) {
    made.codes = isDeep ? new Uint16Array(4 * width * height) : new Uint8ClampedArray(4 * width * height);
    made.data = bits === 8 ? made.codes : new Uint8ClampedArray(4 * width * height);
  }
  for (let row = 0; row < h; row++) {
    const to = 4 * ((y + row) * width + x), part = codes.subarray(4 * w * row, 4 * w * (row + 1));
    made.codes.set(part, to);
    if (bits !== 8) {
      for (let i = 0; i < part.length; i++) {
        made.data[to + i] = i % 4 === 3 ? part[i] : Math.floor((part[i] * 255) / full + 0.5);
      }
    }
  }
  if (w && h) made.context.putImageData(new ImageData(made.data, width, height), 0, 0, x, y, w, h);
  return Object.assign(made, { full, bits, serial: header.serial, header, toned: null });
}

// SHA-256 of the colors that a canvas holds, as `fixedpipe` computes it of a picture [height, width, 3].
async function digestOf(picture) {
  if (!globalThis.crypto?.subtle) return null;
  const { width, height, full, codes } = picture, isDeep = full > 255;
  // What is shown and not what was sent: the canvas is read back, where its bytes are the codes.
  const seen = full === 255 ? picture.context.getImageData(0, 0, width, height).data : codes;
  const head = new TextEncoder().encode(`${height}x${width}x3${isDeep ? " uint16" : ""}\n`);
  const step = isDeep ? 2 : 1, out = new Uint8Array(head.length + 3 * step * width * height);
  out.set(head);
  let at = head.length;
  for (let p = 0; p < seen.length; p += 4) {
    for (let c = 0; c < 3; c++) {
      out[at++] = seen[p + c] & 255;
      if (isDeep) out[at++] = seen[p + c] >> 8;
    }
  }
  const found = await crypto.subtle.digest("SHA-256", out);
  return [...new Uint8Array(found)].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

// `pictures` by name, `numbers` of their differences as the viewer says them, `about` the subject.
function makeModel() {
  const pictures = {};
  let about = null, numbers = {}, names = {};

  const isOld = (name) => Boolean(pictures[name]) && pictures[name].serial !== pictures.machine.serial;
  const fits = (name) => pictures[name]?.width === pictures.machine?.width && pictures[name]?.height === pictures.machine?.height;
  const has = (name) => Boolean(pictures[name] && fits(name));
  const available = () => Object.keys(LAYERS).filter((name) => {
    const of = LAYERS[name].from || name;
    return of === "machine" || of === "ideal" || has(of) || (of === "reference" && about?.reference);
  });

  const measured = new Map();
  function numbersOf(name) {
    const own = { difference: numbers.difference, reference_difference: numbers.reference_difference }[name];
    if (own && !isOld(LAYERS[name].from)) return own;
    const of = pictures[LAYERS[name].from], key = `${name} ${of.serial} ${pictures.machine.serial}`;
    if (!measured.has(key)) {
      if (measured.size > 8) measured.clear();
      const found = differenceOf(pictures.machine, of);
      measured.set(key, { ...found, gain: gainFor(found.max) });
    }
    return measured.get(key);
  }

  const drawings = new Map();
  function differenceShown(name, state) {
    const of = pictures[LAYERS[name].from], gain = state.gain || numbersOf(name).gain;
    if (numbersOf(name).identical) return { note: `Identical: no code differs from ${LAYERS[name].from === "other" ? "B" : `the ${LAYERS[name].from}`}.` };
    const key = `${name} ${of.serial} ${pictures.machine.serial} ${gain} ${state.mode}`;
    if (!drawings.has(key)) {
      if (drawings.size > 3) drawings.clear();
      drawings.set(key, differenceCanvas(pictures.machine, of, gain, state.mode));
    }
    return { canvas: drawings.get(key), x: 0, y: 0 };
  }

  const NOTES = {
    ideal: () => numbers.no_ideal || "The ideal follows when your hand rests.",
    reference: () => "The reference follows when your hand rests; it may take a while.",
    other: () => "B is being drawn.",
  };
  function image(layer, state) {
    const { from } = LAYERS[layer.view], of = from || layer.view;
    if (!pictures.machine || (of !== "machine" && !has(of))) return { note: (NOTES[of] || NOTES.other)() };
    if (from) return isOld(from) ? { note: NOTES[from]() } : differenceShown(layer.view, state);
    const picture = pictures[of];
    if (!state.exposure) return { canvas: picture.canvas, x: 0, y: 0 };
    if (picture.toned?.by !== state.exposure) picture.toned = { by: state.exposure, canvas: tonedCanvas(picture, state.exposure, false) };
    return { canvas: picture.toned.canvas, x: 0, y: 0 };
  }

  function nameOf({ view }) {
    const machine = names.machine || about?.name || "machine", other = names.other || "B";
    const found = { machine, other: `B: ${other}`, ideal: "ideal", reference: "reference", difference: "difference from the ideal",
      reference_difference: "difference from the reference", other_difference: `${machine} \u2212 ${other}` }[view];
    return pictures.machine && has(view) && isOld(view) ? `${found}, of before` : found;
  }

  // Codes, or differences of codes, [red, green, blue].
  function codesAt(name, x, y) {
    const { from } = LAYERS[name], of = from || name;
    if (!has(of) || !has("machine")) return null;
    const i = 4 * (y * pictures.machine.width + x), b = pictures[of];
    if (!b.data[i + 3]) return null;
    if (!from) return [0, 1, 2].map((c) => b.codes[i + c]);
    const whole = pictures.machine.full === b.full ? Math.round : (d) => +d.toFixed(2);
    return [0, 1, 2].map((c) => whole(delta(pictures.machine, i + c, b, i + c) * pictures.machine.full));
  }
  function numbersAt(layer, x, y, state) {
    const found = codesAt(layer.view, x, y);
    if (!found || !found.every(Number.isInteger)) return null;
    const { canvas } = image(layer, state);
    if (!canvas) return null;
    const of = pictures[LAYERS[layer.view].from ? "machine" : layer.view], i = 4 * (y * of.width + x);
    const light = LAYERS[layer.view].from ? 0.5 : (0.2126 * of.data[i] + 0.7152 * of.data[i + 1] + 0.0722 * of.data[i + 2]) / 255;
    return { numbers: found, isLight: light * 2 ** (LAYERS[layer.view].from ? 0 : state.exposure) > 0.4 };
  }

  // The panels of what is shown: a pbuffer has one.
  function panels() {
    const { width, height } = pictures.machine, labels = about?.panels || [""];
    const isWindow = !pictures.machine.header.pbuffer && width % labels.length === 0;
    const each = isWindow ? labels : [""], edge = width / each.length;
    return each.map((label, n) => ({ x: n * edge, y: 0, width: edge, height, label: isWindow ? label : "" }));
  }

  // What the loupe shows of a pixel.
  function seenAt([x, y], state) {
    const panel = panelAt(panels(), x, y);
    const difference = LAYERS[state.shown].from ? state.shown : "difference";
    const views = ["machine", "ideal", difference].filter((name) => has(LAYERS[name].from || name)).map((name) => {
      const shown = image({ view: name, panel: 0 }, state);
      const title = LAYERS[name].from ? `difference \u00d7\u2009${state.gain || numbersOf(name).gain}` : LAYERS[name].name;
      return shown.canvas ? { name: title, canvas: shown.canvas, x, y } : { name: title, note: "identical" };
    });
    const rows = ["machine", "ideal", "reference", "other"].filter(has).map((name) => [LAYERS[name].name, codesAt(name, x, y)]);
    if (has(LAYERS[difference].from)) rows.push([LAYERS[difference].name, codesAt(difference, x, y)]);
    return { title: "", label: panel.label, bits: pictures.machine.bits, views, rows };
  }

  return {
    pictures, available, numbersOf, codesAt, seenAt, has, isOld,
    take(header, bytes) {
      const { name, base } = header, own = pictures[name];
      if (base !== null && own?.number !== base) return false;
      const keeps = base !== null && own.bits === header.bits;
      pictures[name] = Object.assign(pictureOf(header, bytes, keeps ? own : null), { number: header.number });
      return true;
    },
    setAbout(found) { about = found; },
    setNumbers(found) { numbers = found; },
    setNames(found) { names = found; },
    forget(...gone) { for (const name of gone) delete pictures[name]; },
    get about() { return about; },
    get numbers() { return numbers; },
    // As stage.js asks for it.
    stage(state) {
      if (!pictures.machine) return null;
      const { width, height } = pictures.machine;
      return {
        width, height, panels: panels(), title: about?.id || "", labels: null, nameOf, image, numbersAt,
        isEmpty(layer, panel) {
          const of = pictures[LAYERS[layer.view].from || layer.view];
          if (!of) return false;
          const x = Math.floor(panel.x + panel.width / 2), y = Math.floor(panel.y + panel.height / 2);
          return of.data[4 * (y * of.width + x) + 3] === 0;
        },
        state,
      };
    },
  };
}
