// The loupe: a few pixels under the cursor or under the keyboard's place, and their codes.
//
// makeLoupe(announce) takes announce(text), which says it to a screen reader. show(seen, at, event) takes what is
// seen at a pixel, or null: {title, label, bits, views: [{name, canvas, x, y} or {name, note}], rows: [[name, codes]]}:
// canvases with the place of the pixel in them, and codes [red, green, blue] or null.

const AROUND = 5, PIXEL = 9; // pixels on each side of the middle one, and how large each is shown, CSS pixels

function makeLoupe(announce) {
  const element = el("div", { class: "loupe", hidden: true });
  let text = "";

  function magnified({ canvas: picture, x, y }) {
    const edge = 2 * AROUND + 1, { canvas, context } = newCanvas(edge * PIXEL, edge * PIXEL);
    context.imageSmoothingEnabled = false;
    // Drawn by whole pixels; what lies outside the picture stays empty.
    context.drawImage(picture, x - AROUND, y - AROUND, edge, edge, 0, 0, edge * PIXEL, edge * PIXEL);
    context.lineWidth = 1;
    for (const [color, out] of [["#000", 0.5], ["#fff", 1.5]]) {
      context.strokeStyle = color;
      context.strokeRect(AROUND * PIXEL - out, AROUND * PIXEL - out, PIXEL + 2 * out, PIXEL + 2 * out);
    }
    return canvas;
  }

  function show(seen, at, event) {
    element.hidden = !seen;
    if (!seen) return;
    const [x, y] = at, { label, bits, views, rows } = seen;
    element.replaceChildren(
      el("p", {}, el("b", {}, `x ${x}, y ${y}`), label ? `, ${label}` : "", bits > 8 ? `; codes of ${bits} bits` : ""),
      el("div", { class: "views" }, views.map((view) =>
        el("figure", {}, view.canvas ? magnified(view) : el("span", { class: "same" }, view.note), el("figcaption", {}, view.name)))),
      el("table", {},
        el("thead", {}, el("tr", {}, ["", "R", "G", "B"].map((h) => el("th", { scope: "col" }, h)))),
        el("tbody", {}, rows.map(([name, codes]) => el("tr", { "data-row": name },
          el("th", { scope: "row" }, name),
          (codes || ["", "", ""]).map((code) => el("td", {}, String(code).replace("-", "\u2212"))))))));
    text = `x ${x}, y ${y}${label ? `, ${label}` : ""}. ` +
      rows.map(([name, codes]) => `${name}: ${codes ? codes.join(", ") : "none"}`).join(". ");
    place(event);
  }

  // Beside the cursor, where there is room; without a cursor in the stage's corner.
  function place(event) {
    const box = element.parentElement.getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = element;
    let left = box.width - width - 12, top = 12;
    if (event) {
      const x = event.clientX - box.left, y = event.clientY - box.top;
      left = x + 20 + width < box.width ? x + 20 : Math.max(4, x - 20 - width);
      top = Math.max(4, Math.min(y + 20, Math.max(box.height, height + 8) - height - 4));
    }
    element.style.left = `${Math.max(4, left)}px`;
    element.style.top = `${top}px`;
  }
  return { element, show, say: () => announce(element.hidden ? "The loupe is off." : text) };
}
