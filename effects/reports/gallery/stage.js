// The stage: one canvas on which views of a figure are flipped in place, wiped or paired, at one place and
// scale. Panels, their labels and the gutters between them are laid out here; pictures have none of it.

const ZOOMS = [1, 2, 4, 8, 16];
const GUTTER = 10, PAIR_GAP = 28, STRIP = 24, NARROW = 600, SPLIT_STEP = 0.02; // CSS pixels; a step of the divider's keys

function makeStage(set, pointed) {
  const canvas = el("canvas");
  const overlay = el("div", { class: "overlay" });
  const divider = el("div", {
    class: "divider", role: "slider", tabindex: 0, "aria-label": "Divider of the wipe",
    "aria-valuemin": 0, "aria-valuemax": 100, onkeydown: dividerKey,
  });
  const cross = el("div", { class: "cross", hidden: true });
  const element = el("div", {
    class: "stage", tabindex: 0, role: "application", "aria-roledescription": "picture viewer",
    "aria-describedby": "status", "aria-busy": "true",
  }, canvas, overlay, cross, divider);
  let model = null, state = null;

  const ratio = () => window.devicePixelRatio || 1;
  const isLabelled = () => state.labels && model.record.panels.some((panel) => panel.label);
  const isStacked = () => element.clientWidth < NARROW && model.record.panels.length > 1;

  // Panels side by side as in the picture, or one below the other; device pixels.
  function layout(scale) {
    const gutter = isLabelled() ? Math.round(GUTTER * ratio()) : 0;
    const strip = isLabelled() ? Math.round(STRIP * ratio()) : 0;
    const { panels } = model.record, stacked = isStacked();
    const columns = [...new Set(panels.map((p) => p.x))].sort((a, b) => a - b);
    const rows = [...new Set(panels.map((p) => p.y))].sort((a, b) => a - b);
    let below = 0;
    const places = panels.map((panel) => {
      const width = Math.round(panel.width * scale), height = Math.round(panel.height * scale);
      const x = stacked ? 0 : Math.round(panel.x * scale) + gutter * columns.indexOf(panel.x);
      const y = strip + (stacked ? below : Math.round(panel.y * scale) + (gutter + strip) * rows.indexOf(panel.y));
      below += height + strip + gutter;
      return { panel, x, y, width, height };
    });
    return {
      places,
      width: Math.max(...places.map((p) => p.x + p.width)),
      height: Math.max(...places.map((p) => p.y + p.height)),
    };
  }

  function fitScale(width, height) {
    const none = layout(0), { record } = model;
    const wide = isStacked() ? Math.max(...record.panels.map((p) => p.width)) : record.width;
    const high = isStacked() ? record.panels.reduce((sum, p) => sum + p.height, 0) : record.height;
    const scale = Math.min((width - none.width) / wide, isStacked() ? Infinity : (height - none.height) / high);
    // Magnified by whole numbers alone: all pixels are of one size.
    return Math.max(0.01, scale >= 1 ? Math.floor(scale) : scale);
  }
  const scaleOf = (panes) =>
    state.zoom ? Math.max(1, Math.round(state.zoom * ratio())) : fitScale(panes[0].width, panes[0].height);

  // The rectangles in which pictures are drawn, device pixels: two of a pair, side by side or one below the
  // other, as they are larger; else one.
  function panesOf(width, height) {
    if (state.how !== "pair") return [{ view: state.view, x: 0, y: 0, width, height }];
    const gap = Math.round(PAIR_GAP * ratio()), half = (size) => Math.floor((size - gap) / 2);
    const isWide = !isStacked() && fitScale(half(width), height) >= fitScale(width, half(height));
    const w = isWide ? half(width) : width, h = isWide ? height : half(height);
    return [
      { view: state.view, x: 0, y: 0, width: w, height: h },
      { view: state.against, x: isWide ? w + gap : 0, y: isWide ? 0 : h + gap, width: w, height: h },
    ];
  }

  function contentOf(plan, x, y, scale) {
    const inside = (p) => x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height;
    const place = plan.places.find(({ panel }) => inside(panel)) || plan.places[plan.places.length - 1];
    return [place.x + (x - place.panel.x) * scale, place.y + (y - place.panel.y) * scale];
  }
  function centre() {
    return state.centre || [model.record.width / 2, model.record.height / 2];
  }
  // Where the content begins in a pane: its place around the centre, without room that it could fill.
  function originOf(pane, plan, scale) {
    const along = (middle, size, content) =>
      content <= size ? Math.floor((size - content) / 2)
      : Math.round(Math.min(0, Math.max(size - content, size / 2 - middle)));
    const [x, y] = contentOf(plan, ...centre(), scale);
    return [pane.x + along(x, pane.width, plan.width), pane.y + along(y, pane.height, plan.height)];
  }

  function geometry() {
    const panes = panesOf(canvas.width, canvas.height), scale = scaleOf(panes), plan = layout(scale);
    for (const pane of panes) [pane.left, pane.top] = originOf(pane, plan, scale);
    return { panes, scale, plan };
  }

  // The pixel [x, y] under a point of the window, or null.
  function pixelAt(clientX, clientY) {
    const box = canvas.getBoundingClientRect(), { panes, scale, plan } = geometry();
    const px = (clientX - box.left) * ratio(), py = (clientY - box.top) * ratio();
    for (const pane of panes) {
      if (px < pane.x || px >= pane.x + pane.width || py < pane.y || py >= pane.y + pane.height) continue;
      for (const { panel, x, y, width, height } of plan.places) {
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
    const width = element.clientWidth;
    const most = Math.max(320, Math.min(window.innerHeight * 0.74, 1100));
    let height = most;
    if (!state.zoom) {
      const [pane, other] = panesOf(width * ratio(), most * ratio());
      const content = layout(fitScale(pane.width, pane.height)).height / ratio();
      const both = other?.y ? 2 * content + PAIR_GAP : content;
      height = isStacked() ? both : Math.max(Math.min(most, 260), both);
    }
    element.style.height = `${Math.ceil(height)}px`;
    const wanted = [Math.round(width * ratio()), Math.round(Math.ceil(height) * ratio())];
    if (canvas.width !== wanted[0] || canvas.height !== wanted[1]) [canvas.width, canvas.height] = wanted;
  }

  // Draws one view into a pane, clipped to [from, to) of its width.
  function paintView(context, view, pane, plan, scale, from, to) {
    const { canvas: picture } = model.image(view, state);
    if (!picture) return;
    context.save();
    context.beginPath();
    context.rect(from, pane.y, to - from, pane.height);
    context.clip();
    context.imageSmoothingEnabled = scale < 1;
    context.imageSmoothingQuality = "high";
    for (const { panel, x, y, width, height } of plan.places) {
      const left = pane.left + x, top = pane.top + y;
      if (left >= to || left + width <= from || top >= pane.y + pane.height || top + height <= pane.y) continue;
      context.drawImage(picture, panel.x, panel.y, panel.width, panel.height, left, top, width, height);
    }
    context.restore();
  }

  // [{view, pane, from, to}]: the parts of the canvas and what is in each.
  function parts(panes) {
    if (state.how !== "wipe") return panes.map((pane) => ({ view: pane.view, pane, from: pane.x, to: pane.x + pane.width }));
    const [pane] = panes, at = Math.round(pane.width * state.split);
    return [{ view: state.view, pane, from: 0, to: at }, { view: state.against, pane, from: at, to: pane.width }];
  }

  // Texts over the picture in CSS pixels: {class, text, left, top, width}.
  function texts({ panes, plan }) {
    const found = [], r = ratio();
    for (const part of parts(panes)) {
      const { pane, view, from, to } = part, { note } = model.image(view, state);
      if (note) found.push({ class: "note", text: note, left: from / r, top: pane.y / r, width: (to - from) / r, height: pane.height / r });
      if (state.how !== "one") {
        const isRight = state.how === "wipe" && from > 0;
        found.push({ class: isRight ? "side right" : "side", text: model.nameOfView(view), left: from / r, width: (to - from) / r, top: (pane.y + pane.height) / r - 30 });
      }
      if (note) continue;
      for (const { panel, x, y, width, height } of plan.places) {
        const left = Math.max(from, pane.left + x), right = Math.min(to, pane.left + x + width);
        const bottom = Math.min(pane.y + pane.height, pane.top + y + height);
        const top = Math.max(pane.y, pane.top + y);
        if (right <= left || bottom <= top) continue;
        if (model.isEmpty(view, panel)) {
          found.push({ class: "note", text: "no reference", left: left / r, top: top / r, width: (right - left) / r, height: (bottom - top) / r });
        }
      }
    }
    if (!isLabelled()) return found;
    for (const pane of panes) {
      for (const { panel, x, y, width, height } of plan.places) {
        const left = Math.max(pane.x, pane.left + x), right = Math.min(pane.x + pane.width, pane.left + x + width);
        const over = pane.top + y - STRIP * r, top = Math.max(pane.y, over);
        if (right - left < 20 * r || pane.top + y + height <= top || top >= pane.y + pane.height) continue;
        found.push({ class: top > over ? "label inside" : "label", text: panel.label, left: left / r, top: top / r, width: (right - left) / r });
      }
    }
    return found;
  }

  function draw() {
    if (!model) return;
    size();
    const context = canvas.getContext("2d"), at = geometry(), r = ratio();
    context.clearRect(0, 0, canvas.width, canvas.height);
    for (const { view, pane, from, to } of parts(at.panes)) paintView(context, view, pane, at.plan, at.scale, from, to);
    overlay.replaceChildren(...texts(at).map((text) => el("span", {
      class: text.class,
      style: `left:${text.left}px;top:${text.top}px;max-width:${text.width}px;` +
        (text.height ? `width:${text.width}px;height:${text.height}px` : text.class.startsWith("side right") ? `width:${text.width}px` : ""),
    }, el("span", {}, text.text))));
    divider.hidden = state.how !== "wipe";
    divider.style.left = `${state.split * 100}%`;
    divider.setAttribute("aria-valuenow", Math.round(state.split * 100));
    cross.hidden = !state.at;
    if (state.at) {
      const [pane] = at.panes, [x, y] = contentOf(at.plan, ...state.at, at.scale), edge = Math.max(at.scale, 3 * r);
      cross.style.left = `${(pane.left + x) / r}px`;
      cross.style.top = `${(pane.top + y) / r}px`;
      cross.style.width = cross.style.height = `${edge / r}px`;
    }
    element.dataset.scale = String(at.scale);
    element.classList.toggle("zoomed", state.zoom > 0);
  }

  // How large a pixel is shown, in words.
  function scaleInWords() {
    const { scale } = geometry();
    return scale >= 1 ? `${scale}:1` : `${Math.round(scale * 100)} %, smoothed`;
  }

  // The centre that keeps the pixel [x, y] under the same point of the window at another zoom.
  function zoomed(zoom, clientX, clientY) {
    const pixel = clientX === undefined ? null : pixelAt(clientX, clientY);
    if (!pixel || !zoom) return { zoom, ...(zoom ? {} : { centre: null }) };
    const box = canvas.getBoundingClientRect(), { panes } = geometry();
    const step = Math.max(1, Math.round(zoom * ratio()));
    const x = (clientX - box.left) * ratio(), y = (clientY - box.top) * ratio();
    const pane = panes.find((p) => x >= p.x && y >= p.y && x < p.x + p.width && y < p.y + p.height);
    return { zoom, centre: within([
      pixel[0] - (x - pane.x - pane.width / 2) / step,
      pixel[1] - (y - pane.y - pane.height / 2) / step,
    ]) };
  }
  function within([x, y]) {
    const clamp = (value, most) => Math.min(most - 1, Math.max(0, Math.round(value)));
    return [clamp(x, model.record.width), clamp(y, model.record.height)];
  }
  function step(by) {
    const levels = [0, ...ZOOMS];
    const now = state.zoom ? levels.indexOf(state.zoom) : Math.max(0, ZOOMS.filter((z) => z * ratio() <= geometry().scale).length);
    return levels[Math.min(levels.length - 1, Math.max(0, now + by))] ?? 0;
  }
  function zoomBy(by, clientX, clientY) {
    const next = step(by);
    const around = state.centre || state.at || null;
    set({ ...(clientX === undefined ? { zoom: next, centre: next ? around : null } : zoomed(next, clientX, clientY)) });
  }
  // Moves by so many CSS pixels. The centre is first brought to where clamping has it.
  function panned(dx, dy) {
    const { panes: [pane], scale, plan } = geometry();
    const middle = (size, content, begin, own) => (content <= size ? own : size / 2 - begin);
    const [ownX, ownY] = contentOf(plan, ...centre(), scale);
    const x = middle(pane.width, plan.width, pane.left - pane.x, ownX) - dx * ratio();
    const y = middle(pane.height, plan.height, pane.top - pane.y, ownY) - dy * ratio();
    const nearest = (value, low, high) => Math.min(high, Math.max(low, value));
    let best = null;
    for (const place of plan.places) {
      const px = nearest(x, place.x, place.x + place.width - 1), py = nearest(y, place.y, place.y + place.height - 1);
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
    drag = { x: event.clientX, y: event.clientY, isDivider: event.target === divider, moved: false };
    if (event.pointerType === "mouse" || drag.isDivider || state.zoom) element.setPointerCapture(event.pointerId);
  });
  element.addEventListener("pointermove", (event) => {
    if (!model) return;
    const dx = drag ? event.clientX - drag.x : 0, dy = drag ? event.clientY - drag.y : 0;
    if (drag?.isDivider) {
      const box = canvas.getBoundingClientRect();
      set({ split: Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)) });
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
  element.addEventListener("wheel", (event) => {
    // The page scrolls over the stage unless it was chosen: by a click, by the keyboard or with Ctrl.
    if (!model || !(event.ctrlKey || state.zoom || element.contains(document.activeElement))) return;
    event.preventDefault();
    zoomBy(event.deltaY < 0 ? 1 : -1, event.clientX, event.clientY);
  }, { passive: false });

  function dividerKey(event) {
    const by = { ArrowLeft: -SPLIT_STEP, ArrowRight: SPLIT_STEP, PageDown: -0.1, PageUp: 0.1 }[event.key];
    const split = { Home: 0, End: 1 }[event.key] ?? (by === undefined ? undefined : Math.min(1, Math.max(0, state.split + by)));
    if (split === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    set({ split });
  }

  // What is shown as a PNG: pictures, labels and gutters on the page's paper.
  function save() {
    const { canvas: copy, context } = newCanvas(canvas.width, canvas.height), r = ratio();
    const style = getComputedStyle(element);
    context.fillStyle = style.backgroundColor;
    context.fillRect(0, 0, copy.width, copy.height);
    context.drawImage(canvas, 0, 0);
    context.fillStyle = style.color;
    context.font = `${13 * r}px ${style.fontFamily}`;
    context.textBaseline = "middle";
    for (const text of texts(geometry())) {
      context.fillText(text.text, (text.left + 6) * r, (text.top + (text.height || STRIP) / 2) * r, text.width * r);
    }
    return new Promise((resolve) => copy.toBlob(resolve, "image/png"));
  }

  new ResizeObserver(draw).observe(element);
  return {
    element, step, zoomBy, within, scaleInWords, save, pixelAt,
    panBy: (dx, dy) => panned(dx, dy),
    show(newModel, newState) {
      [model, state] = [newModel, newState];
      element.setAttribute("aria-busy", String(!model));
      element.setAttribute("aria-label", model ? `${model.record.id}, ${model.nameOfView(state.view)}` : "loading");
      draw();
    },
  };
}
