// Where panels and panes stand on a stage: numbers alone, in device pixels.
//
// A *plan* places panels, {places: [{panel, x, y, width, height}], width, height}. A *pane* is a rectangle of
// the stage, {layer, x, y, width, height}, and `left`, `top` where its plan's corner stands in it.

const GUTTER = 10, PANE_GAP = 28, STRIP = 24, NARROW = 600; // CSS pixels

// Panels side by side as in the picture, or one below the other. `isLabelled`: with room for their labels.
function planOf(panels, scale, ratio, isLabelled, isStacked) {
  const gutter = isLabelled ? Math.round(GUTTER * ratio) : 0;
  const strip = isLabelled ? Math.round(STRIP * ratio) : 0;
  const columns = [...new Set(panels.map((p) => p.x))].sort((a, b) => a - b);
  const rows = [...new Set(panels.map((p) => p.y))].sort((a, b) => a - b);
  const [first] = panels;
  let below = 0;
  const places = panels.map((panel) => {
    const width = Math.round(panel.width * scale), height = Math.round(panel.height * scale);
    const x = isStacked ? 0 : Math.round((panel.x - first.x) * scale) + gutter * columns.indexOf(panel.x);
    const y = strip + (isStacked ? below : Math.round((panel.y - first.y) * scale) + (gutter + strip) * rows.indexOf(panel.y));
    below += height + strip + gutter;
    return { panel, x, y, width, height };
  });
  return {
    places,
    width: Math.max(...places.map((p) => p.x + p.width)),
    height: Math.max(...places.map((p) => p.y + p.height)),
  };
}

// The scale at which panels fit; from 1:1 on whole numbers alone, so that all pixels are of one size.
function fittingScale(panels, width, height, ratio, isLabelled, isStacked) {
  const none = planOf(panels, 0, ratio, isLabelled, isStacked);
  const reach = (begin, size) => Math.max(...panels.map((p) => p[begin] + p[size])) - Math.min(...panels.map((p) => p[begin]));
  const wide = isStacked ? Math.max(...panels.map((p) => p.width)) : reach("x", "width");
  const scale = Math.min((width - none.width) / wide, isStacked ? Infinity : (height - none.height) / reach("y", "height"));
  return Math.max(0.01, scale >= 1 ? Math.floor(scale) : scale);
}

// So many panes of one size: of all ways in rows and columns the one with the largest pictures of that shape.
function panesIn(layers, width, height, gap, scaleIn) {
  let best = null;
  for (let columns = 1; columns <= layers.length; columns++) {
    const rows = Math.ceil(layers.length / columns);
    const size = [Math.floor((width - gap * (columns - 1)) / columns), Math.floor((height - gap * (rows - 1)) / rows)];
    const scale = size[0] > 0 && size[1] > 0 ? scaleIn(...size) : 0;
    if (!best || scale > best.scale) best = { scale, columns, size };
  }
  const [w, h] = best.size;
  return layers.map((layer, n) => ({
    layer, width: w, height: h,
    x: (n % best.columns) * (w + gap), y: Math.floor(n / best.columns) * (h + gap),
  }));
}

const isInside = (p, x, y) => x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height;
// The rectangle of those that has a pixel, else the last.
const panelAt = (panels, x, y) => panels.find((p) => isInside(p, x, y)) || panels[panels.length - 1];

// A rectangle of a size, moved into the panel of a model in which its middle is.
function cropIn(model, x, y, size) {
  const middle = [clamped(x + size.width / 2, 0, model.width - 1), clamped(y + size.height / 2, 0, model.height - 1)];
  const panel = panelAt(model.panels, ...middle);
  const width = Math.min(size.width, panel.width), height = Math.min(size.height, panel.height);
  return {
    x: clamped(Math.round(x), panel.x, panel.x + panel.width - width),
    y: clamped(Math.round(y), panel.y, panel.y + panel.height - height), width, height,
  };
}
