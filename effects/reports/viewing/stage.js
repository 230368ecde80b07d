// The stage: one canvas on which layers are flipped in place, wiped, paired, subtracted or all seen at once, at
// one place and scale. Panels, their labels and the gutters between them are laid out here; pictures have none.
//
// A *layer* is {view, panel}, or {view, panel, minus: {view, panel}}: `view` a name that the model knows, `panel`
// 0 for the whole row of panels or the number of one, from 1.
//
// makeStage(set, pointed) takes set(changes), which changes the state and calls show again, and pointed(at, event,
// isClick). What it shows:
//   model  {width, height, panels: [{x, y, width, height, label}], title, labels: as in labels.js or null,
//           nameOf(layer): words,
//           image(layer, state): {canvas, x, y}, the canvas's corner in the picture's pixels, or {note: words},
//           isEmpty(layer, panel): whether there is no picture in it,
//           numbersAt(layer, x, y, state): {numbers: [red, green, blue], isLight} or null}
//   state  {layers: [layer], how: "one", "wipe" or "panes", split, zoom, centre, at, labels, crop}
// x and y are pixels of the whole row of panels. `at` is marked, `crop` {x, y, width, height} is dragged.

const ZOOMS = [1, 2, 4, 8, 16, 32, 64];
const SPLIT_STEP = 0.02; // of the divider's keys
const WHEEL_STEP = 100; // pixels of a wheel for a step of the zoom, as a mouse's notch has them

function makeStage(set, pointed) {
  const canvas = el("canvas");
  const overlay = el("div", { class: "overlay" });
  const divider = el("div", {
    class: "divider", role: "slider", tabindex: 0, "aria-label": "Divider of the wipe",
    "aria-valuemin": 0, "aria-valuemax": 100, onkeydown: dividerKey,
  });
  const marks = el("div", { class: "marks" });
  const element = el("div", {
    class: "stage", tabindex: 0, role: "application", "aria-roledescription": "picture viewer",
    "aria-describedby": "status", "aria-busy": "true",
  }, canvas, overlay, marks, divider);
  let model = null, state = null;

  const ratio = () => window.devicePixelRatio || 1;
  const panelOf = (layer) => model.panels[layer.panel - 1];
  const panelsOf = (layer) => (layer.panel ? [panelOf(layer)] : model.panels);
  const isSingle = () => panelsOf(state.layers[0]).length === 1 && model.panels.length > 1;
  const isLabelled = () => state.labels && !isSingle() && model.panels.some((panel) => panel.label);
  const isStacked = () => element.clientWidth < NARROW && panelsOf(state.layers[0]).length > 1;
  const plan = (layer, scale) => planOf(panelsOf(layer), scale, ratio(), isLabelled(), isStacked());
  const fitScale = (width, height) =>
    fittingScale(panelsOf(state.layers[0]), width, height, ratio(), isLabelled(), isStacked());
  const scaleOf = (panes) =>
    state.zoom ? Math.max(1, Math.round(state.zoom * ratio())) : fitScale(panes[0].width, panes[0].height);

  function panesOf(width, height) {
    if (state.how !== "panes") return [{ layer: state.layers[0], x: 0, y: 0, width, height }];
    const gap = Math.round(PANE_GAP * ratio());
    if (isStacked()) {
      const high = Math.floor((height - gap * (state.layers.length - 1)) / state.layers.length);
      return state.layers.map((layer, n) => ({ layer, x: 0, y: n * (high + gap), width, height: high }));
    }
    return panesIn(state.layers, width, height, gap, fitScale);
  }

  function centre() {
    if (state.centre) return state.centre;
    const [first] = panelsOf(state.layers[0]);
    return isSingle() ? [first.x + first.width / 2, first.y + first.height / 2] : [model.width / 2, model.height / 2];
  }
  // Where a pixel of any panel stands in a plan: in a plan of one panel at the same place of that panel.
  function contentOf(ofPlan, x, y, scale) {
    const { places } = ofPlan, own = panelAt(model.panels, x, y);
    const place = isSingle() ? places[0] : places.find(({ panel }) => panel === own);
    return [place.x + (x - own.x) * scale, place.y + (y - own.y) * scale];
  }
  // Where the content begins in a pane: its place around the centre, without room that it could fill.
  function originOf(pane, ofPlan, scale) {
    const along = (middle, size, content) =>
      content <= size ? Math.floor((size - content) / 2)
      : Math.round(Math.min(0, Math.max(size - content, size / 2 - middle)));
    const [x, y] = contentOf(ofPlan, ...centre(), scale);
    return [pane.x + along(x, pane.width, ofPlan.width), pane.y + along(y, pane.height, ofPlan.height)];
  }
  function geometry() {
    const panes = panesOf(canvas.width, canvas.height), scale = scaleOf(panes);
    for (const pane of panes) {
      pane.plan = plan(pane.layer, scale);
      [pane.left, pane.top] = originOf(pane, pane.plan, scale);
    }
    return { panes, scale };
  }

  // The pixel [x, y] under a point of the window, or null.
  function pixelAt(clientX, clientY) {
    const box = canvas.getBoundingClientRect(), { panes, scale } = geometry();
    const px = (clientX - box.left) * ratio(), py = (clientY - box.top) * ratio();
    for (const pane of panes.filter((one) => isInside(one, px, py))) {
      for (const { panel, x, y, width, height } of pane.plan.places) {
        const dx = px - pane.left - x, dy = py - pane.top - y;
        if (dx >= 0 && dy >= 0 && dx < width && dy < height) {
          return [
            panel.x + Math.min(panel.width - 1, Math.floor(dx / scale)),
            panel.y + Math.min(panel.height - 1, Math.floor(dy / scale)),
          ];
        }
      }
    }
    return null;
  }

  function size() {
    const width = element.clientWidth, r = ratio();
    const most = Math.max(320, Math.min(window.innerHeight * 0.74, 1100));
    let height = most;
    if (!state.zoom) {
      const panes = panesOf(width * r, most * r), [pane] = panes;
      const content = plan(pane.layer, fitScale(pane.width, pane.height)).height / r;
      const rows = new Set(panes.map((one) => one.y)).size, all = rows * content + (rows - 1) * PANE_GAP;
      height = isStacked() ? all : Math.max(Math.min(most, 260), all);
    }
    element.style.height = `${Math.ceil(height)}px`;
    const wanted = [Math.round(width * r), Math.round(Math.ceil(height) * r)];
    if (canvas.width !== wanted[0] || canvas.height !== wanted[1]) [canvas.width, canvas.height] = wanted;
  }

  // Draws a layer into a pane, clipped to [from, to) of its width.
  function paint(context, { layer, pane, from, to }, scale) {
    const image = model.image(layer, state);
    if (!image.canvas) return;
    context.save();
    context.beginPath();
    context.rect(from, pane.y, to - from, pane.height);
    context.clip();
    context.imageSmoothingEnabled = scale < 1;
    context.imageSmoothingQuality = "high";
    const places = plan(layer, scale).places;
    for (const { panel, x, y, width, height } of places) {
      const left = pane.left + x, top = pane.top + y;
      if (left >= to || left + width <= from || top >= pane.y + pane.height || top + height <= pane.y) continue;
      context.drawImage(image.canvas, panel.x - image.x, panel.y - image.y, panel.width, panel.height, left, top, width, height);
      if (scale >= LEAST_SCALE) writeCodes(context, layer, panel, left, top, scale, { from, to, y: pane.y, end: pane.y + pane.height });
    }
    context.restore();
  }

  // The numbers of the pixels that are seen of a panel: codes, or differences of codes.
  function writeCodes(context, layer, panel, left, top, scale, seen) {
    const begin = (low, at) => Math.max(0, Math.floor((low - at) / scale));
    const columns = [begin(seen.from, left), Math.min(panel.width, Math.ceil((seen.to - left) / scale))];
    const rows = [begin(seen.y, top), Math.min(panel.height, Math.ceil((seen.end - top) / scale))];
    for (let y = rows[0]; y < rows[1]; y++) {
      for (let x = columns[0]; x < columns[1]; x++) {
        const found = model.numbersAt(layer, panel.x + x, panel.y + y, state);
        if (found) writeNumbers(context, found.numbers, left + x * scale, top + y * scale, scale, found.isLight);
      }
    }
  }

  // [{layer, pane, from, to}]: the parts of the canvas and what is in each.
  function parts(panes) {
    if (state.how !== "wipe") return panes.map((pane) => ({ layer: pane.layer, pane, from: pane.x, to: pane.x + pane.width }));
    const [pane] = panes, at = Math.round(pane.width * state.split);
    return [{ layer: state.layers[0], pane, from: 0, to: at }, { layer: state.layers[1], pane, from: at, to: pane.width }];
  }

  // Texts over the picture in CSS pixels: {class, text, left, top, width}.
  function texts({ panes }) {
    const found = [], r = ratio();
    for (const part of parts(panes)) {
      const { pane, layer, from, to } = part, { note } = model.image(layer, state);
      if (note) found.push({ class: "note", text: note, left: from / r, top: pane.y / r, width: (to - from) / r, height: pane.height / r });
      if (state.how !== "one") {
        const isRight = state.how === "wipe" && from > 0;
        const bottom = Math.min(pane.y + pane.height, pane.top + pane.plan.height, canvas.height);
        found.push({ class: isRight ? "side right" : "side", text: model.nameOf(layer), left: from / r, width: (to - from) / r, top: bottom / r - 30 });
      }
      if (note) continue;
      for (const { panel, x, y, width, height } of plan(layer, scaleOf(panes)).places) {
        const left = Math.max(from, pane.left + x), right = Math.min(to, pane.left + x + width);
        const top = Math.max(pane.y, pane.top + y), bottom = Math.min(pane.y + pane.height, pane.top + y + height);
        if (right > left && bottom > top && model.isEmpty(layer, panel)) {
          found.push({ class: "note", text: "no reference", left: left / r, top: top / r, width: (right - left) / r, height: (bottom - top) / r });
        }
      }
    }
    if (!isLabelled()) return found;
    for (const pane of panes) {
      for (const { panel, x, y, width, height } of pane.plan.places) {
        const left = Math.max(pane.x, pane.left + x), right = Math.min(pane.x + pane.width, pane.left + x + width);
        const over = pane.top + y - STRIP * r, top = Math.max(pane.y, over);
        if (right - left < 20 * r || pane.top + y + height <= top || top >= pane.y + pane.height) continue;
        found.push({ class: top > over ? "label inside" : "label", text: panel.label, left: left / r, top: top / r, width: (right - left) / r });
      }
    }
    return found;
  }

  // The letters that are seen: {label, left, top} in device pixels.
  function letters({ panes, scale }) {
    const found = [];
    for (const pane of panes) {
      if (!model.labels?.length || model.image(pane.layer, state).note || pane.layer.minus) continue;
      for (const { panel, x, y } of pane.plan.places) {
        for (const label of model.labels.filter((one) => isInside(panel, one.x, one.y))) {
          const left = pane.left + x + (label.x - panel.x) * scale, top = pane.top + y + (label.y - panel.y) * scale;
          if (isInside(pane, left, top)) found.push({ label, left, top });
        }
      }
    }
    return found;
  }

  function draw() {
    if (!model) return;
    size();
    const context = canvas.getContext("2d"), at = geometry(), r = ratio();
    context.clearRect(0, 0, canvas.width, canvas.height);
    for (const part of parts(at.panes)) paint(context, part, at.scale);
    overlay.replaceChildren(
      ...letters(at).map(({ label, left, top }) => labelElement(label, left / r, top / r, at.scale / r)),
      ...texts(at).map((text) => el("span", {
        class: text.class,
        style: `left:${text.left}px;top:${text.top}px;max-width:${text.width}px;` +
          (text.height ? `width:${text.width}px;height:${text.height}px` : text.class.startsWith("side right") ? `width:${text.width}px` : ""),
      }, el("span", {}, text.text))));
    divider.hidden = state.how !== "wipe";
    divider.style.left = `${state.split * 100}%`;
    divider.setAttribute("aria-valuenow", Math.round(state.split * 100));
    mark(at);
    element.dataset.scale = String(at.scale);
    element.classList.toggle("zoomed", state.zoom > 0);
  }

  // The loupe's pixel and the rectangle of the strip, in every pane.
  function mark({ panes, scale }) {
    const r = ratio(), boxes = [];
    const add = (pane, name, x, y, width, height, least) => {
      const [left, top] = contentOf(pane.plan, x, y, scale);
      boxes.push(el("div", { class: name, style:
        `left:${(pane.left + left) / r}px;top:${(pane.top + top) / r}px;width:${Math.max(width * scale, least) / r}px;height:${Math.max(height * scale, least) / r}px` }));
    };
    for (const pane of panes) {
      if (state.crop) add(pane, "crop", state.crop.x, state.crop.y, state.crop.width, state.crop.height, 0);
      if (state.at && !(boxes.some((box) => box.className === "cross") && state.how !== "panes")) add(pane, "cross", ...state.at, 1, 1, 3 * r);
    }
    marks.replaceChildren(...boxes);
  }

  // How large a pixel is shown, in words.
  function scaleInWords() {
    const { scale } = geometry();
    return scale >= 1 ? `${scale}:1` : `${Math.round(scale * 100)} %, smoothed`;
  }

  // The centre that keeps the pixel under a point of the window there at another zoom.
  function zoomed(zoom, clientX, clientY) {
    const pixel = clientX === undefined ? null : pixelAt(clientX, clientY);
    if (!pixel || !zoom) return { zoom, ...(zoom ? {} : { centre: null }) };
    const box = canvas.getBoundingClientRect(), { panes } = geometry();
    const step = Math.max(1, Math.round(zoom * ratio()));
    const x = (clientX - box.left) * ratio(), y = (clientY - box.top) * ratio();
    const pane = panes.find((p) => isInside(p, x, y));
    return { zoom, centre: within([
      pixel[0] - (x - pane.x - pane.width / 2) / step,
      pixel[1] - (y - pane.y - pane.height / 2) / step,
    ]) };
  }
  function within([x, y]) {
    const whole = (value, most) => clamped(Math.round(value), 0, most - 1);
    return [whole(x, model.width), whole(y, model.height)];
  }
  function step(by) {
    const levels = [0, ...ZOOMS];
    const now = state.zoom ? levels.indexOf(state.zoom) : Math.max(0, ZOOMS.filter((z) => z * ratio() <= geometry().scale).length);
    return levels[clamped(now + by, 0, levels.length - 1)] ?? 0;
  }
  function zoomBy(by, clientX, clientY) {
    const next = step(by), around = state.centre || state.at || null;
    set({ ...(clientX === undefined ? { zoom: next, centre: next ? around : null } : zoomed(next, clientX, clientY)) });
  }
  // The centre after a move by so many CSS pixels. It is first brought to where clamping has it.
  function panned(dx, dy) {
    const { panes: [pane], scale } = geometry();
    const middle = (length, content, begin, own) => (content <= length ? own : length / 2 - begin);
    const [ownX, ownY] = contentOf(pane.plan, ...centre(), scale);
    const x = middle(pane.width, pane.plan.width, pane.left - pane.x, ownX) - dx * ratio();
    const y = middle(pane.height, pane.plan.height, pane.top - pane.y, ownY) - dy * ratio();
    let best = null;
    for (const place of pane.plan.places) {
      const px = clamped(x, place.x, place.x + place.width - 1), py = clamped(y, place.y, place.y + place.height - 1);
      const far = Math.hypot(px - x, py - y);
      if (!best || far < best.far) {
        best = { far, at: [place.panel.x + (px - place.x) / scale, place.panel.y + (py - place.y) / scale] };
      }
    }
    return best.at;
  }

  let drag = null;
  element.addEventListener("pointerdown", (event) => {
    if (!model || event.button) return;
    const pixel = pixelAt(event.clientX, event.clientY);
    const isCrop = Boolean(state.crop && pixel && event.target !== divider && isInCrop(pixel));
    drag = { x: event.clientX, y: event.clientY, isDivider: event.target === divider, isCrop, crop: state.crop, pixel, moved: false };
    if (event.pointerType === "mouse" || drag.isDivider || isCrop || state.zoom) element.setPointerCapture(event.pointerId);
  });
  // Whether a pixel is in the rectangle of the strip, of its own panel or at the same place of another.
  function isInCrop([x, y]) {
    const own = panelAt(model.panels, x, y), of = panelAt(model.panels, state.crop.x, state.crop.y);
    return isInside({ ...state.crop, x: state.crop.x - of.x, y: state.crop.y - of.y }, x - own.x, y - own.y);
  }
  element.addEventListener("pointermove", (event) => {
    if (!model) return;
    const dx = drag ? event.clientX - drag.x : 0, dy = drag ? event.clientY - drag.y : 0;
    if (drag?.isDivider) {
      const box = canvas.getBoundingClientRect();
      set({ split: clamped((event.clientX - box.left) / box.width, 0, 1) });
    } else if (drag?.isCrop && (drag.moved || Math.hypot(dx, dy) > 3)) {
      drag.moved = true;
      const by = ratio() / geometry().scale;
      set({ crop: cropIn(model, drag.crop.x + dx * by, drag.crop.y + dy * by, drag.crop) });
    } else if (drag && state.zoom && (drag.moved || Math.hypot(dx, dy) > 3)) {
      Object.assign(drag, { x: event.clientX, y: event.clientY, moved: true });
      set({ centre: panned(dx, dy) });
    } else if (!drag) pointed(pixelAt(event.clientX, event.clientY), event);
  });
  element.addEventListener("pointerup", (event) => {
    if (drag && !drag.moved && !drag.isDivider) pointed(pixelAt(event.clientX, event.clientY), event, true);
    drag = null;
  });
  element.addEventListener("pointercancel", () => { drag = null; });
  element.addEventListener("pointerleave", (event) => { if (!drag) pointed(null, event); });
  let wheeled = 0;
  element.addEventListener("wheel", (event) => {
    // The page scrolls over the stage unless it was chosen: by a click, by the keyboard or with Ctrl.
    if (!model || !(event.ctrlKey || state.zoom || element.contains(document.activeElement))) return;
    event.preventDefault();
    // A trackpad sends many small moves; what they add up to counts. Lines and pages are as a mouse's notch.
    const moved = event.deltaMode ? Math.sign(event.deltaY) * WHEEL_STEP : event.deltaY;
    wheeled = Math.sign(moved) === -Math.sign(wheeled) ? moved : wheeled + moved;
    const steps = Math.trunc(wheeled / WHEEL_STEP);
    if (!steps) return;
    wheeled -= steps * WHEEL_STEP;
    zoomBy(-steps, event.clientX, event.clientY);
  }, { passive: false });

  function dividerKey(event) {
    const by = { ArrowLeft: -SPLIT_STEP, ArrowRight: SPLIT_STEP, PageDown: -0.1, PageUp: 0.1 }[event.key];
    const split = { Home: 0, End: 1 }[event.key] ?? (by === undefined ? undefined : clamped(state.split + by, 0, 1));
    if (split === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    set({ split });
  }

  // What is shown as a PNG: pictures, letters, labels on plates as on the page, gutters on the page's ground.
  function save() {
    const { canvas: copy, context } = newCanvas(canvas.width, canvas.height), r = ratio();
    const style = getComputedStyle(element), at = geometry();
    context.fillStyle = style.backgroundColor;
    context.fillRect(0, 0, copy.width, copy.height);
    context.drawImage(canvas, 0, 0);
    for (const { label, left, top } of letters(at)) writeLabel(context, label, left, top, at.scale, style.fontFamily, LEAST_LETTERS * r);
    context.font = `${13 * r}px ${style.fontFamily}`;
    context.textBaseline = "middle";
    for (const text of texts(at)) writePlate(context, text, style, r);
    return new Promise((resolve) => copy.toBlob(resolve, "image/png"));
  }
  function writePlate(context, text, style, r) {
    const middle = (text.top + (text.height || STRIP) / 2) * r, pad = 6 * r;
    const wide = Math.min(context.measureText(text.text).width, text.width * r - 2 * pad);
    const left = text.class.endsWith("right") ? (text.left + text.width) * r - wide - 2 * pad
      : text.height ? (text.left + text.width / 2) * r - wide / 2 - pad : text.left * r;
    if (text.class !== "label" && text.class !== "note") {
      context.fillStyle = style.getPropertyValue("--paper");
      context.fillRect(left, middle - 11 * r, wide + 2 * pad, 22 * r);
    }
    context.fillStyle = style.color;
    context.textAlign = "left";
    context.fillText(text.text, left + pad, middle, Math.max(1, wide));
  }

  new ResizeObserver(draw).observe(element);
  return {
    element, step, zoomBy, within, scaleInWords, save, pixelAt,
    panBy: (dx, dy) => panned(dx, dy),
    show(newModel, newState) {
      [model, state] = [newModel, newState];
      element.setAttribute("aria-busy", String(!model));
      element.setAttribute("aria-label", model ? `${model.title}, ${model.nameOf(state.layers[0])}` : "loading");
      draw();
    },
  };
}
