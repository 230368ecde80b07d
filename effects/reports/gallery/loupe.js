// The loupe: a few pixels under the cursor or under the keyboard's place, and their codes.

const AROUND = 5, PIXEL = 9; // pixels on each side of the middle one, and how large each is shown, CSS pixels

function makeLoupe(said) {
  const element = el("div", { class: "loupe", hidden: true });
  let text = "";

  function magnified(picture, x, y) {
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

  function show(model, state, at, event) {
    element.hidden = !at || !model;
    if (element.hidden) return;
    const [x, y] = at, { record } = model;
    const panel = record.panels.find((p) => x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height);
    const rows = model.values(x, y, state.view);
    const difference = VIEWS[state.view].from ? state.view : model.differences()[0];
    const views = ["machine", "ideal", ...(difference ? [difference] : [])].filter((view) => model.available.includes(view));
    const bits = model.drawn.bits || 8;
    element.replaceChildren(
      el("p", {}, el("b", {}, `x ${x}, y ${y}`), panel?.label ? `, ${panel.label}` : "", bits > 8 ? `; codes of ${bits} bits` : ""),
      el("div", { class: "views" }, views.map((view) => {
        const { canvas } = model.image(view, state);
        return el("figure", {}, canvas ? magnified(canvas, x, y) : el("span", { class: "same" }, "identical"),
          el("figcaption", {}, VIEWS[view].from ? `difference \u00d7\u2009${model.gainOf(view, state)}` : VIEWS[view].name));
      })),
      el("table", {},
        el("thead", {}, el("tr", {}, ["", "R", "G", "B"].map((h) => el("th", { scope: "col" }, h)))),
        el("tbody", {}, rows.map(([name, codes]) => el("tr", { "data-row": name },
          el("th", { scope: "row" }, name),
          (codes || ["", "", ""]).map((code) => el("td", {}, String(code).replace("-", "\u2212"))))))));
    text = `x ${x}, y ${y}${panel?.label ? `, ${panel.label}` : ""}. ` +
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
  return { element, show, say: () => said(element.hidden ? "The loupe is off." : text) };
}
