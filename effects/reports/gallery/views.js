// The views of a figure: what can be seen of it on machine A, and beside machine B where one is chosen; and what
// the stage, the loupe and the strip (effects/reports/viewing) are told of them: the model.

const VIEWS = {
  machine: { name: "machine", key: "1" },
  ideal: { name: "ideal", key: "2" },
  reference: { name: "reference", key: "3" },
  difference: { name: "difference", key: "4", from: "ideal" },
  reference_difference: { name: "\u2212 reference", key: "5", from: "reference" },
  other: { name: "B", key: "b" },
  other_difference: { name: "\u2212 B", key: "6", from: "other" },
};
// Two pictures together: what it is called, and its key.
const HOW = {
  wipe: ["wipe", "w"], pair: ["pair", "p"], minus: ["subtract", "m"], panels: ["all panels", "a"],
};

// All pictures of machine A of a record, and B's: {machine, ideal, reference, other}, those that there are.
async function picturesOf(drawn, other) {
  const wanted = { ...drawn.pictures, ...(other ? { other: other.pictures.machine } : {}) };
  const found = Object.entries(wanted).filter(([view, { digest }]) => digest && VIEWS[view] && !VIEWS[view].from);
  return Object.fromEntries(
    await Promise.all(found.map(async ([view, picture]) => [view, await pictureOf(picture)])),
  );
}

// The layers that a state shows, as the stage takes them.
function layersOf(state, model) {
  const own = { view: state.view, panel: state.panel };
  const other = { view: state.against || state.view, panel: state.beside || state.panel };
  if (state.how === "panels") return model.panels.map((_, n) => ({ view: state.view, panel: n + 1 }));
  if (state.how === "minus") return [{ ...own, minus: other }];
  return state.how === "one" ? [own] : [own, other];
}

// What the stage needs of a figure on its machines.
function makeModel(record, drawn, other, pictures) {
  const { panels, width, height } = record;
  const available = Object.keys(VIEWS).filter((view) => pictures[VIEWS[view].from || view]);
  const wholeFigure = { x: 0, y: 0, width, height };
  const rectangleOf = ({ panel }) => (panel ? panels[panel - 1] : wholeFigure);
  const differences = () => available.filter((view) => VIEWS[view].from);

  // The two pictures that a layer subtracts and their rectangles, or null.
  function termsOf(layer) {
    const { view, minus } = layer, { from } = VIEWS[view], of = rectangleOf(layer);
    if (minus) return { a: pictures[view], of, b: pictures[minus.view], with: rectangleOf(minus) };
    return from ? { a: pictures.machine, of, b: pictures[from], with: of } : null;
  }
  const keyOf = ({ view, panel, minus }) => `${view} ${panel} ${minus ? keyOf(minus) : ""}`;

  const measured = new Map();
  // {max, at, pixels, rms, identical, gain, flip} of a layer that subtracts: the record's numbers of a difference
  // of whole pictures, which are of the unrounded ideal; else what is found here, of codes.
  function numbers(layer) {
    const said = !layer.minus && !layer.panel && { difference: drawn.difference, reference_difference: drawn.reference_difference }[layer.view];
    if (said) return said;
    const key = keyOf(layer);
    if (!measured.has(key)) {
      const { a, of, b, with: beside } = termsOf(layer), found = differenceOf(a, b, of, beside);
      measured.set(key, { ...found, gain: gainFor(found.max) });
    }
    return measured.get(key);
  }
  const gainOf = (layer, state) => state.gain || numbers(layer).gain;

  const drawings = new Map();
  function made(key, make) {
    if (!drawings.has(key)) {
      if (drawings.size > 12) drawings.clear();
      drawings.set(key, make());
    }
    return drawings.get(key);
  }
  // {canvas, x, y} or, where there is nothing to draw, {note}
  function image(layer, state) {
    const terms = termsOf(layer);
    if (!terms) {
      const isFalse = state.tone === "false";
      return made(`${layer.view} ${state.exposure} ${isFalse}`, () =>
        ({ canvas: tonedCanvas(pictures[layer.view], state.exposure, isFalse), x: 0, y: 0 }));
    }
    const { a, of, b, with: beside } = terms, found = numbers(layer);
    if (found.identical) return { note: `Identical. ${nameOf(minuend(layer))} and ${nameOf(subtrahend(layer))} agree in every bit of every pixel.` };
    const gain = gainOf(layer, state);
    return made(`${keyOf(layer)} ${gain} ${state.mode}`, () =>
      ({ canvas: differenceCanvas(a, b, gain, state.mode, of, beside), x: of.x, y: of.y }));
  }
  const minuend = ({ view, panel }) => ({ view: VIEWS[view].from ? "machine" : view, panel });
  const subtrahend = (layer) => layer.minus || { view: VIEWS[layer.view].from, panel: layer.panel };

  const panelName = (panel) => (panel ? panels[panel - 1].label || `panel ${panel}` : "");
  function nameOfView(view) {
    if (view === "machine") return machineName(drawn.profile);
    if (view === "other") return `B: ${machineName(other.profile)}`;
    if (VIEWS[view].from) return `${machineName(drawn.profile)} \u2212 ${VIEWS[view].from === "other" ? machineName(other?.profile) : VIEWS[view].from}`;
    return view;
  }
  function nameOf(layer) {
    const named = ({ view, panel }) => [panel && panels.length > 1 ? panelName(panel) : "", nameOfView(view)].filter(Boolean).join(", ");
    return layer.minus ? `${named(layer)} \u2212 ${named(layer.minus)}` : named(layer);
  }
  // Where a panel has no reference, alpha is 0: asked at its middle.
  function isEmpty(layer, panel) {
    const picture = pictures[VIEWS[layer.view].from || layer.view];
    const x = Math.floor(panel.x + panel.width / 2), y = Math.floor(panel.y + panel.height / 2);
    return picture.data[4 * (y * picture.width + x) + 3] === 0;
  }

  const codesAt = (picture, x, y) => {
    const at = 4 * (y * picture.width + x);
    return picture.data[at + 3] ? [0, 1, 2].map((c) => picture.codes[at + c]) : null;
  };
  // What a layer that subtracts has at a pixel, in codes of its first picture; null where one has none.
  function deltaAt(layer, x, y) {
    const { a, of, b, with: beside } = termsOf(layer);
    const i = 4 * (y * a.width + x), j = 4 * ((y - of.y + beside.y) * b.width + x - of.x + beside.x);
    if (!a.data[i + 3] || !b.data[j + 3]) return null;
    return [0, 1, 2].map((c) => {
      const d = delta(a, i + c, b, j + c) * a.full;
      return a.full === b.full ? Math.round(d) : +d.toFixed(2);
    });
  }
  function numbersAt(layer, x, y, state) {
    const shown = image(layer, state);
    if (!shown.canvas) return null;
    const found = termsOf(layer) ? deltaAt(layer, x, y)?.map(Math.round) : codesAt(pictures[layer.view], x, y);
    if (!found) return null;
    shown.pixels ||= shown.canvas.getContext("2d").getImageData(0, 0, shown.canvas.width, shown.canvas.height);
    const at = 4 * ((y - shown.y) * shown.pixels.width + x - shown.x);
    const light = LUMINANCE.reduce((sum, weight, c) => sum + weight * shown.pixels.data[at + c], 0);
    return { numbers: found, isLight: light > 110 };
  }

  // What the loupe shows at a pixel.
  function seen(x, y, state) {
    const panel = panelAt(panels, x, y), layers = layersOf(state, model);
    const wanted = layers.find(termsOf) || (differences().length ? { view: differences()[0], panel: 0 } : null);
    const isThere = wanted && (!wanted.panel || panels[wanted.panel - 1] === panel);
    const views = ["machine", "ideal"].filter((view) => pictures[view]).map((view) => ({ view, panel: 0 }));
    const rows = Object.keys(pictures).map((view) => [view === "other" ? nameOfView(view) : view, codesAt(pictures[view], x, y)]);
    if (state.panel || state.how === "panels") {
      for (const one of panels.filter((each) => each !== panel)) {
        rows.push([one.label || `panel ${panels.indexOf(one) + 1}`, codesAt(pictures.machine, one.x + x - panel.x, one.y + y - panel.y)]);
      }
    }
    const d = isThere && deltaAt(wanted, x, y);
    if (d) rows.push([wanted.minus ? "difference" : VIEWS[wanted.view].name, d]);
    return {
      label: panel.label, bits: drawn.bits || 8, rows,
      views: [...views, ...(isThere ? [wanted] : [])].map((layer) => {
        const { canvas, note, x: left, y: top } = image(layer, state);
        const name = termsOf(layer) ? `${layer.minus ? "difference" : VIEWS[layer.view].name} \u00d7\u2009${gainOf(layer, state)}` : layer.view;
        return canvas ? { name, canvas, x: x - left, y: y - top } : { name, note: "identical" };
      }),
    };
  }
  // The rectangle `crop` of machine, ideal and reference, or with `inPanels` of the machine in each panel.
  function crops(crop, state, inPanels) {
    const own = panelAt(panels, crop.x, crop.y);
    const cut = (view, name, panel) => ({
      name, ...crop, x: panel.x + crop.x - own.x, y: panel.y + crop.y - own.y, canvas: image({ view, panel: 0 }, state).canvas,
    });
    if (inPanels) return panels.map((panel, n) => cut(state.view in pictures ? state.view : "machine", panelName(n + 1), panel));
    const there = ["machine", "ideal", "reference"].filter((view) => pictures[view] && !isEmpty({ view }, own));
    return there.map((view) => cut(view, nameOfView(view), own));
  }

  const model = {
    record, drawn, other, pictures, panels, width, height, available, title: record.id, labels: drawn.labels || record.labels,
    differences, numbers, gainOf, image, nameOf, nameOfView, panelName, isEmpty, numbersAt, seen, crops, termsOf, rectangleOf,
  };
  return model;
}
