// The views of a figure: what can be seen of it on machine A, and beside machine B where one is chosen.

const VIEWS = {
  machine: { name: "machine", key: "1" },
  ideal: { name: "ideal", key: "2" },
  reference: { name: "reference", key: "3" },
  difference: { name: "difference", key: "4", from: "ideal" },
  reference_difference: { name: "from reference", key: "5", from: "reference" },
  other: { name: "B", key: "b" },
  other_difference: { name: "A \u2212 B", key: "6", from: "other" },
};

// All pictures of machine A of a record, and B's: {machine, ideal, reference, other}, those that there are.
async function picturesOf(drawn, other) {
  const wanted = { ...drawn.pictures, ...(other ? { other: other.pictures.machine } : {}) };
  const found = Object.entries(wanted).filter(([view]) => VIEWS[view] && !VIEWS[view].from);
  return Object.fromEntries(
    await Promise.all(found.map(async ([view, picture]) => [view, await pictureOf(picture)])),
  );
}

// What the stage needs of a figure on its machines.
function makeModel(record, drawn, other, pictures) {
  const available = Object.keys(VIEWS).filter((view) => pictures[VIEWS[view].from || view]);
  const measured = {};

  // What the record says of a difference; of A - B, which it does not know, what is found here.
  function numbers(view) {
    const said = { difference: drawn.difference, reference_difference: drawn.reference_difference }[view];
    if (said) return said;
    measured[view] ||= differenceOf(pictures.machine, pictures[VIEWS[view].from]);
    const { max } = measured[view];
    return { ...measured[view], gain: max ? Math.min(128, 2 ** Math.max(0, Math.floor(Math.log2(0.5 / max)))) : 1 };
  }
  const gainOf = (view, state) => state.gain || numbers(view).gain;
  const differences = () => available.filter((view) => VIEWS[view].from);

  const drawings = new Map();
  // {canvas} or, where there is nothing to draw, {note}
  function image(view, state) {
    const { from } = VIEWS[view];
    if (!from) return { canvas: pictures[view].canvas };
    if (numbers(view).identical) {
      const what = from === "other" ? `${nameOf(drawn.profile)} and ${nameOf(other.profile)}` : `The machine and the ${from}`;
      return { note: `Identical. ${what} agree in every bit of every pixel.` };
    }
    const key = `${view} ${gainOf(view, state)} ${state.mode}`;
    if (!drawings.has(key)) {
      if (drawings.size > 5) drawings.clear();
      drawings.set(key, differenceCanvas(pictures.machine, pictures[from], gainOf(view, state), state.mode));
    }
    return { canvas: drawings.get(key) };
  }
  function nameOfView(view) {
    if (view === "machine") return nameOf(drawn.profile);
    if (view === "other") return `B: ${nameOf(other.profile)}`;
    return { ideal: "ideal", reference: "reference", difference: "difference from the ideal",
      reference_difference: "difference from the reference",
      other_difference: `${nameOf(drawn.profile)} \u2212 ${nameOf(other?.profile)}` }[view];
  }
  // Where a panel has no reference, alpha is 0: asked at its middle.
  function isEmpty(view, panel) {
    const picture = pictures[VIEWS[view].from || view];
    const x = Math.floor(panel.x + panel.width / 2), y = Math.floor(panel.y + panel.height / 2);
    return picture.data[4 * (y * picture.width + x) + 3] === 0;
  }
  // Rows of the loupe at a pixel: [name, [red, green, blue]]; codes, differences of codes.
  function values(x, y, view) {
    const at = 4 * (y * record.width + x), codes = (name) => [0, 1, 2].map((c) => pictures[name].codes[at + c]);
    const rows = Object.keys(pictures).filter((name) => name !== "other").map((name) =>
      [name, pictures[name].data[at + 3] ? codes(name) : null]);
    if (pictures.other) rows.push([`B, ${nameOf(other.profile)}`, codes("other")]);
    const shown = VIEWS[view].from ? view : differences()[0];
    if (shown && pictures[VIEWS[shown].from].data[at + 3]) {
      const full = pictures.machine.full, b = pictures[VIEWS[shown].from];
      rows.push([VIEWS[shown].name, [0, 1, 2].map((c) => {
        const d = delta(pictures.machine, b, at + c) * full;
        return b.full === full ? Math.round(d) : +d.toFixed(2);
      })]);
    }
    return rows;
  }
  return { record, drawn, other, pictures, available, differences, numbers, gainOf, image, nameOfView, isEmpty, values };
}
