// Labels and formulas as text over a picture.
//
// A label is {runs, x, y, size, color, halo, align: [h, v]}: `runs` is [[text, level], ...], level -1 for what
// stands low, as an index does, and 0 else; a line ends at "\n". x and y are in the picture's pixels from its
// left top corner, `size` is the height of a line there. `align` says which part of the label is at the place,
// -1, 0, 1: left, middle or right, and lower edge, middle or upper edge. `halo`: the color around letters.

const LEAST_LETTERS = 9.34; // CSS pixels: 7 points
const LETTERS_IN_LINE = 0.82; // of a line's height

const fontSizeOf = (label, scale) => Math.max(LEAST_LETTERS, LETTERS_IN_LINE * label.size * scale);

// The lines of a label, each a list of [text, level].
function linesOf(label) {
  const lines = [[]];
  for (const [text, level] of label.runs) {
    text.split("\n").forEach((part, n) => {
      if (n) lines.push([]);
      if (part) lines[lines.length - 1].push([part, level]);
    });
  }
  return lines;
}

// An element for a label. `left`, `top`: its place; `scale`: of the picture, all in CSS pixels.
function labelElement(label, left, top, scale) {
  const [h, v] = label.align, along = `${-50 * (h + 1)}%`, down = `${-50 * (1 - v)}%`;
  return el("span", {
    class: "letters",
    style: `left:${left}px;top:${top}px;font-size:${fontSizeOf(label, scale)}px;color:${label.color};` +
      `transform:translate(${along},${down});text-align:${["left", "center", "right"][h + 1]};` +
      (label.halo ? `--halo:${label.halo};` : ""),
  }, linesOf(label).map((line) => el("span", { class: "line" },
    line.map(([text, level]) => (level < 0 ? el("sub", {}, text) : text)))));
}

// Writes a label on a canvas, as `labelElement` places it; `left`, `top` and `scale` in the canvas's pixels.
function writeLabel(context, label, left, top, scale, family, least) {
  const size = Math.max(least, LETTERS_IN_LINE * label.size * scale), lines = linesOf(label), leading = 1.2 * size;
  const font = (level) => `${level < 0 ? 0.72 * size : size}px ${family}`;
  const [h, v] = label.align;
  let y = top - 0.5 * (1 - v) * leading * lines.length + 0.9 * size;
  context.textBaseline = "alphabetic";
  context.textAlign = "left";
  context.lineJoin = "round";
  for (const line of lines) {
    const widths = line.map(([text, level]) => {
      context.font = font(level);
      return context.measureText(text).width;
    });
    let x = left - 0.5 * (h + 1) * widths.reduce((sum, width) => sum + width, 0);
    line.forEach(([text, level], n) => {
      context.font = font(level);
      const low = level < 0 ? 0.22 * size : 0;
      if (label.halo) {
        context.strokeStyle = label.halo;
        context.lineWidth = 0.22 * size;
        context.strokeText(text, x, y + low);
      }
      context.fillStyle = label.color;
      context.fillText(text, x, y + low);
      x += widths[n];
    });
    y += leading;
  }
}
