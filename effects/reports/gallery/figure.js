// A figure's page: its bars, the stage with the loupe and the strip, and what stands below.

// Edges of a crop, and how many times as large each is shown.
const CROPS = { 24: 8, 48: 4, 96: 2 };

function makeFigure(set, go, announce) {
  const loupe = makeLoupe(announce), strip = makeStrip(), stage = makeStage(setOnStage, pointed);
  let state = null, model = null, wanted = "";
  // The loupe is at state.at where it is pinned: by a click, a key or the address. Else it follows the cursor.
  let lensOn = false, followed = null, isPinnedByDefault = false;

  const button = (text, key, onclick, attributes = {}) =>
    el("button", { type: "button", "aria-keyshortcuts": key, title: key ? `${attributes.title || text} (${key})` : attributes.title || text, onclick },
      text, key && key.length === 1 ? el("kbd", { "aria-hidden": "true" }, key) : null);
  const choice = (name, onchange) => el("select", { "aria-label": name, onchange });
  const bar = (name, ...children) => el("div", { class: "bar", role: "group", "aria-label": name }, children);
  const of = (text) => el("span", { class: "of" }, text);
  const pressed = (one, isOn) => one.setAttribute("aria-pressed", String(isOn));

  const title = el("h1", { tabindex: -1 });
  const before = el("a", { class: "step", "aria-keyshortcuts": "ArrowLeft" }), after = el("a", { class: "step", "aria-keyshortcuts": "ArrowRight" });
  const up = el("a", { class: "step", "aria-keyshortcuts": "Escape" }, "All figures");
  const machines = bar("Machine"), panels = bar("Panel"), viewBar = bar("View");
  const other = choice("Machine B", () => set({ other: other.value, ...(other.value ? {} : plainly()) }));
  const otherLabel = bar("Machine B", el("label", {}, of("B"), other));
  const status = el("p", { class: "status", id: "status" }), hint = el("p", { class: "hint", hidden: true });
  const how = Object.fromEntries(Object.entries(HOW).map(([name, [text, key]]) => [name, button(text, key, () => compare(name))]));
  const against = choice("Beside it", () => set({ against: against.value }));
  const beside = choice("Panel beside it", () => set(pairOfPanels(Number(beside.value))));
  const partners = el("label", {}, of("with"), against, beside);
  const gain = el("input", { type: "range", min: 0, max: 7, step: 1, "aria-label": "Gain of the difference", oninput: () => set({ gain: 2 ** Number(gain.value) }) });
  const gainText = el("output", {}), mode = choice("Difference shown", () => set({ mode: mode.value }));
  mode.append(...Object.entries(MODES).map(([value, text]) => el("option", { value }, text)));
  const legend = el("span", { class: "legend", "aria-hidden": "true" }, el("i"));
  const gainBar = bar("Difference", el("label", { class: "gain" }, "gain", gain, gainText), mode);
  const exposure = el("input", { type: "range", min: 0, max: 6, step: 1, "aria-label": "Exposure", oninput: () => set({ exposure: Number(exposure.value) }) });
  const exposureText = el("output", {});
  const falseColor = button("false color", "f", () => set({ tone: state.tone ? "" : "false" }));
  const exposureBar = bar("Exposure", el("label", { class: "gain" }, "exposure", exposure, exposureText), falseColor);
  const zoomText = el("output", { class: "zoom", "aria-live": "off" });
  const lens = button("loupe", "l", () => toggleLens()), labels = button("labels", "t", () => set({ labels: !state.labels }));
  const largest = button("largest difference", "d", () => goToLargest());
  const say = button("read pixel aloud", "v", () => loupe.say()), crops = button("crops", "x", () => toggleCrop());
  const stripBar = el("div", { class: "bars under", hidden: true }, bar("Crops", of("crops"),
    ...Object.entries(CROPS).map(([edge, by]) => button(`${edge} px \u00d7 ${by}`, "", () => recrop(Number(edge)))),
    button("save the strip", "", saveStrip)));
  const bottom = el("div", { class: "below" });
  const failure = el("p", { class: "failed", role: "alert", hidden: true });
  const failures = el("div", { class: "failures" });

  const element = el("article", { class: "figure" },
    el("nav", { "aria-label": "Figures" }, up, el("span", { class: "steps" }, before, after)),
    title,
    el("div", { class: "bars" }, machines, otherLabel),
    el("div", { class: "bars" }, panels, viewBar, bar("Beside", Object.values(how), partners)),
    failures, failure,
    el("div", { class: "frame" }, stage.element, loupe.element),
    hint,
    el("div", { class: "bars under" },
      bar("Zoom", button("\u2212", "", () => stage.zoomBy(-1), { title: "smaller" }), zoomText, button("+", "", () => stage.zoomBy(1), { title: "larger" }),
        button("fit", "0", () => set({ zoom: 0, centre: null })), button("1:1", "", () => set({ zoom: 1 }))),
      gainBar, exposureBar, legend,
      bar("Look", largest, lens, say, crops, labels),
      bar("Save", button("save the picture", "s", savePicture, { title: "the machine's own pixels as PNG" }), button("save view", "S", saveView, { title: "what is shown as PNG" }))),
    status, stripBar, strip.element, bottom);
  element.querySelectorAll(".bar button").forEach((one) => {
    if (one.textContent === "\u2212") one.setAttribute("aria-label", "smaller");
    if (one.textContent === "+") one.setAttribute("aria-label", "larger");
  });

  function tell(text) {
    announce(text);
    hint.textContent = text;
    hint.hidden = false;
  }

  // ------------------------------------------------------------------------------------------- what is shown

  // Without B nothing of B is shown.
  const plainly = () => ({
    view: ["other", "other_difference"].includes(state.view) ? "machine" : state.view,
    ...(["other", "other_difference"].includes(state.against) ? { how: "one", against: "" } : {}),
  });
  // Another machine keeps what is beside it, and the place.
  const chooseMachine = (machine) => set({ machine, ...(state.other === machine ? { other: "", ...plainly() } : {}) });
  const layers = () => layersOf(state, model);
  const subtracting = () => layers().find((layer) => model.termsOf(layer));
  const plainViews = () => model.available.filter((view) => !VIEWS[view].from);

  // The view or the panel that is beside what is shown where none was chosen.
  function partner(name) {
    if (state.panel && model.panels.length > 1) return { against: state.view, beside: state.panel === 1 ? 2 : 1 };
    const views = name === "minus" ? plainViews() : model.available, rest = views.filter((view) => view !== state.view);
    const view = rest.includes("other") ? "other" : rest.find((one) => one === "ideal") || rest[0];
    return view ? { against: view, beside: 0 } : model.panels.length > 1 ? { panel: 2, against: state.view, beside: 1 } : null;
  }
  function compare(name) {
    if (!model) return;
    if (state.how === name) return set({ how: "one", against: "", beside: 0 });
    if (name === "panels") {
      if (model.panels.length < 2) return tell("This figure has one panel.");
      return set({ how: name, panel: 0, against: "", beside: 0 });
    }
    const isPlain = name !== "minus" || !VIEWS[state.view].from;
    const kept = state.against && (name !== "minus" || !VIEWS[state.against].from) ? { against: state.against, beside: state.beside } : null;
    const chosen = kept || partner(name);
    if (!chosen) return tell("There is nothing beside it: choose machine B.");
    const view = isPlain ? state.view : "machine";
    if (chosen.against === view && (chosen.beside || state.panel) === (chosen.panel ?? state.panel)) return tell("Choose another view or panel to compare with.");
    set({ how: name, view, ...chosen });
  }
  // The panel beside it; where all were shown, one is chosen to be compared.
  function pairOfPanels(number) {
    const panel = number && !state.panel ? (number === 1 ? 2 : 1) : state.panel;
    return { beside: number, panel };
  }
  function chooseView(view) {
    if (!model) return;
    if (!model.available.includes(view)) {
      return tell(VIEWS[view].from === "other" || view === "other" ? "Choose machine B first." : `This figure has no ${VIEWS[view].from || view} here.`);
    }
    // Flipping to what is beside it changes places.
    const isSwap = state.against === view && (state.beside || state.panel) === state.panel && state.how !== "minus";
    set({ view, ...(isSwap ? { against: state.view } : {}), ...(state.how === "minus" && VIEWS[view].from ? { how: "one", against: "", beside: 0 } : {}) });
  }
  function choosePanel(number) {
    if (!model || model.panels.length < 2) return tell("This figure has one panel.");
    if (number < 0 || number > model.panels.length) return undefined;
    // The same place of another panel, and the panel that was shown beside it.
    const move = (at) => {
      if (!at || !number) return at;
      const own = panelAt(model.panels, ...at), next = model.panels[number - 1];
      return [at[0] - own.x + next.x, at[1] - own.y + next.y];
    };
    const isBeside = number && state.how !== "one" && state.how !== "panels" && (state.beside || state.panel) === number && state.against === state.view;
    return set({
      panel: number, at: move(state.at), centre: move(state.centre),
      ...(state.how === "panels" ? { how: "one" } : {}), ...(isBeside ? { beside: state.panel } : {}),
      ...(!number && state.beside ? { how: "one", against: "", beside: 0 } : {}),
    });
  }
  function flip() {
    if (!model?.other) return tell("Choose machine B first.");
    return chooseView(state.view === "other" ? "machine" : "other");
  }
  // The next machine that draws other bits, in place.
  function nextMachine(by) {
    const all = model.record.machines, found = all.filter((one) => !one.same_bits_as || one === model.drawn);
    if (found.length < 2) return tell("All machines draw the same bits.");
    const next = found[(found.indexOf(model.drawn) + by + found.length) % found.length];
    return chooseMachine(next.profile);
  }
  function goToLargest() {
    const shown = subtracting(), views = model?.differences() || [];
    const view = views.includes("reference_difference") ? "reference_difference" : views[0];
    const layer = shown || (view && { view, panel: state.panel });
    if (!layer) return;
    const { at, identical } = model.numbers(layer);
    if (identical || !at) return tell("There is no difference.");
    isPinnedByDefault = false;
    set({ at, centre: at, zoom: Math.max(state.zoom, 8), ...(shown ? {} : { view }) });
    loupe.say();
  }
  function gainBy(by) {
    const layer = subtracting() || (model.differences().length && { view: model.differences()[0], panel: 0 });
    if (layer) set({ gain: clamped(model.gainOf(layer, state) * by, 1, 128) });
  }

  // -------------------------------------------------------------------------------------- loupe and crops

  function pointed(at, event, isClick) {
    if (!lensOn || (isClick && !at)) return;
    if (isClick) {
      isPinnedByDefault = false;
      set({ at: state.at && event.pointerType === "mouse" ? null : at });
    } else if (!state.at || (isPinnedByDefault && at)) {
      followed = at && { at, event };
      if (state.at) set({ at: null });
      else showLoupe();
    }
  }
  const showLoupe = () => {
    const where = state.at ? { at: state.at } : lensOn && followed;
    loupe.show(where && model && model.seen(...where.at, state), where?.at, where?.event);
  };
  function toggleLens() {
    if (!model) return;
    lensOn = !(lensOn || state.at);
    followed = null;
    isPinnedByDefault = lensOn;
    set({ at: lensOn ? stage.within(state.centre || middle()) : null });
  }
  function middle() {
    const { x, y, width, height } = state.panel ? model.panels[state.panel - 1] : model;
    return [(x || 0) + width / 2, (y || 0) + height / 2];
  }
  const rectangle = () => {
    if (!state.crop) return null;
    const [x, y, edge] = state.crop;
    return cropIn(model, x, y, { width: clamped(edge, 4, 256), height: clamped(edge, 4, 256) });
  };
  function setOnStage(changes) {
    set(changes.crop ? { ...changes, crop: [changes.crop.x, changes.crop.y, changes.crop.width] } : changes);
  }
  function recrop(edge) {
    const [x, y, now] = state.crop || [...(state.at || state.centre || middle()), 0];
    set({ crop: [x + (now - edge) / 2, y + (now - edge) / 2, edge] });
  }
  const toggleCrop = () => (state.crop ? set({ crop: null }) : recrop(48));
  // The strip: one place of this machine, its ideal and reference, and of all machines that draw other bits.
  let stripOf = "";
  async function showStrip() {
    const crop = rectangle();
    stripBar.hidden = !crop;
    if (!crop) {
      stripOf = "";
      return strip.show([], 1);
    }
    const shown = model, by = CROPS[crop.width] || clamped(Math.floor(192 / crop.width), 1, 16);
    const cuts = shown.crops(crop, state, state.how === "panels");
    const rest = state.how === "panels" ? [] : shown.record.machines.filter((one) => one !== shown.drawn && !one.same_bits_as && one.profile !== shown.drawn.same_bits_as);
    const key = `${shown.record.id} ${shown.drawn.profile}`;
    if (stripOf !== key) strip.show(cuts, by);
    const pictures = await Promise.all(rest.map((one) => pictureOf(one.pictures.machine)));
    if (shown !== model || !state.crop) return undefined;
    stripOf = key;
    return strip.show([...cuts, ...pictures.map((picture, n) =>
      ({ name: machineName(rest[n].profile), ...rectangle(), canvas: tonedCanvas(picture, state.exposure, state.tone === "false") }))], by);
  }

  // ------------------------------------------------------------------------------------------------- saving

  const fileName = (...parts) => `${[state.id, model.drawn.profile, ...parts.filter(Boolean).map((part) => part.replaceAll("_", "-"))].join("-")}.png`;
  const panelPart = () => (state.panel ? `panel-${state.panel}` : "");
  // The picture itself: a machine's own pixels, whole or a panel; of what is computed here, what is shown of it.
  async function savePicture() {
    if (!model) return;
    const [layer] = layers(), view = VIEWS[layer.view].from || layer.minus ? "machine" : layer.view;
    offer(await pngOf(model.pictures[view], model.rectangleOf(layer)), fileName(view === "machine" ? "" : view, panelPart()));
  }
  async function saveView() {
    if (model) offer(await stage.save(), fileName(state.view === "machine" ? "" : state.view, panelPart(), state.how === "one" ? "" : state.how, "view"));
  }
  async function saveStrip() {
    if (model && state.crop) offer(await strip.save(), fileName("crops"));
  }

  // ------------------------------------------------------------------------------------------------ loading

  // The record and the pictures of a figure on its machines; what came for another is dropped.
  async function load(next) {
    const key = [next.id, next.machine, next.other].join("\n");
    if (key === wanted) return;
    const isSame = wanted.split("\n")[0] === next.id;
    wanted = key;
    model = isSame ? model : null;
    stage.element.setAttribute("aria-busy", "true");
    try {
      const record = await recordOf(next.id);
      failures.replaceChildren(...failuresOf(record, FIGURES.get(next.id)));
      element.classList.toggle("undrawn", !record.machines.length);
      if (!record.machines.length) {
        bottom.replaceChildren(...below(record, null, FIGURES.get(next.id), set).filter(Boolean));
        return;
      }
      const drawn = record.machines.find((one) => one.profile === next.machine) || record.machines[0];
      const besideIt = record.machines.find((one) => one.profile === next.other && one !== drawn);
      const pictures = await picturesOf(drawn, besideIt);
      if (key !== wanted) return;
      model = makeModel(record, drawn, besideIt, pictures);
      failure.hidden = true;
      bottom.replaceChildren(...below(record, drawn, FIGURES.get(next.id), set).filter(Boolean));
      fillMachines(record, drawn, besideIt);
      update(state);
    } catch (error) {
      if (key !== wanted) return;
      wanted = "";
      failure.textContent = error.message;
      failure.hidden = false;
    }
  }

  function fillMachines(record, drawn, besideIt) {
    const hadFocus = machines.contains(document.activeElement);
    machines.replaceChildren(of("machine"), ...record.machines.map((one) => {
      const same = one.same_bits_as && machineName(one.same_bits_as);
      const chip = el("button", {
        type: "button", class: same ? "chip same" : "chip", "data-machine": one.profile, "aria-pressed": String(one === drawn),
        title: same ? `${one.profile}: the same bits as ${same}` : `${one.profile} (\u2191 \u2193: the machine before, after)`, onclick: () => chooseMachine(one.profile),
      }, machineName(one.profile), same ? el("span", { class: "away" }, `, the same bits as ${same}`) : null);
      return chip;
    }));
    if (hadFocus) machines.querySelector("[aria-pressed=true]")?.focus({ preventScroll: true });
    other.replaceChildren(el("option", { value: "", selected: !besideIt }, "no other"),
      ...record.machines.filter((one) => one !== drawn).map((one) => el("option", { value: one.profile, selected: one === besideIt },
        machineName(one.profile) + (one.same_bits_as ? ` (= ${machineName(one.same_bits_as)})` : ""))));
    otherLabel.hidden = record.machines.length < 2;
  }

  function updateBars() {
    const shown = state.view, several = model.panels.length > 1, layer = subtracting();
    viewBar.replaceChildren(...model.available.map((view) => {
      const one = button(VIEWS[view].name, VIEWS[view].key, () => chooseView(view), { title: model.nameOfView(view) });
      pressed(one, view === shown);
      one.dataset.view = view;
      return one;
    }));
    panels.hidden = !several;
    panels.replaceChildren(of("panel"), ...["all", ...model.panels.map((panel, n) => panel.label || String(n + 1))].map((text, n) => {
      const one = button(text, "", () => choosePanel(n), { title: n ? `${text} (Shift ${n})` : "all panels (Shift 0)" });
      one.classList.add("chip");
      one.dataset.panel = n;
      pressed(one, state.how !== "panels" && n === state.panel);
      return one;
    }));
    const views = state.how === "minus" ? plainViews() : model.available;
    against.replaceChildren(...views.map((view) => el("option", { value: view, selected: view === (state.against || shown) }, model.nameOfView(view))));
    beside.replaceChildren(el("option", { value: 0, selected: !state.beside }, state.panel ? "same panel" : "all panels"),
      ...model.panels.map((_, n) => el("option", { value: n + 1, selected: state.beside === n + 1 }, model.panelName(n + 1))));
    beside.hidden = !several;
    partners.hidden = ["one", "panels"].includes(state.how);
    for (const [name, one] of Object.entries(how)) {
      pressed(one, state.how === name);
      one.disabled = model.available.length < 2 && !several;
    }
    how.panels.hidden = !several;
    gainBar.hidden = !layer;
    const value = layer ? model.gainOf(layer, state) : 1;
    gain.value = String(Math.log2(value));
    gain.setAttribute("aria-valuetext", `times ${value}`);
    gainText.textContent = `\u00d7 ${value}`;
    mode.value = state.mode;
    const isPicture = layers().some((one) => !model.termsOf(one));
    exposureBar.hidden = !isPicture;
    exposure.value = String(state.exposure);
    exposureText.textContent = `\u00d7 ${2 ** state.exposure}`;
    exposure.setAttribute("aria-valuetext", `times ${2 ** state.exposure}`);
    pressed(falseColor, state.tone === "false");
    const isRamp = layer && state.mode === "color", isTone = isPicture && state.tone;
    legend.hidden = !isRamp && !isTone;
    legend.dataset.most = fourDigits(1 / (isRamp ? value : 2 ** state.exposure));
    pressed(labels, state.labels);
    labels.hidden = !model.panels.some((panel) => panel.label);
    pressed(lens, lensOn);
    pressed(crops, Boolean(state.crop));
    largest.disabled = !model.differences().length;
    zoomText.textContent = stage.scaleInWords();
    status.replaceChildren(...statusOf(layer));
  }

  // What is shown, in words: the caption, exposure, the difference's numbers, pixels and bits.
  function statusOf(layer) {
    const { drawn, record } = model, shown = state.view, parts = [];
    const add = (...said) => parts.push(...said);
    if (layer) {
      const { rms, max, at, pixels, identical, flip } = model.numbers(layer);
      add(el("b", {}, model.nameOf(layer)), `, \u00d7 ${model.gainOf(layer, state)}${{ signed: " about middle grey", absolute: " on black", color: ", the largest component" }[state.mode]}. `);
      if (identical) add(`Identical; RMS ${fourDigits(rms)}. `);
      else {
        add(`RMS ${fourDigits(rms)}, largest ${fourDigits(max)} at x ${at[0]}, y ${at[1]} (1 = full); ${pixels.toLocaleString("en")} pixels differ`);
        add(typeof flip === "number" ? `; FLIP ${fourDigits(flip)}. ` : ". ");
      }
    } else {
      if (shown !== "machine" && shown !== "other") add(el("b", {}, shown), ": ");
      add(`${shown === "other" ? model.nameOfView(shown) : drawn.pictures[shown].caption}. `);
    }
    if (state.how === "wipe" || state.how === "pair") add(`Beside it: ${model.nameOf(layers()[1])}. `);
    if (state.exposure || state.tone) add(`Shown \u00d7 ${2 ** state.exposure}${state.tone ? ", luminance in false color" : ""}. `);
    add(`${record.width} \u00d7 ${record.height} pixels`, drawn.bits ? `, ${drawn.bits} bits a component` : "", ". ");
    const same = record.machines.filter((one) => one.same_bits_as === drawn.profile).map((one) => machineName(one.profile));
    add(drawn.same_bits_as ? `The same bits as ${machineName(drawn.same_bits_as)}. ` : same.length ? `The same bits on ${same.join(", ")}. ` : "");
    return parts;
  }

  // ------------------------------------------------------------------------------------------------ figures

  function step(by) {
    const found = matches(state), list = found.some((f) => f.id === state.id) ? found : IN_ORDER;
    const next = list[list.findIndex((figure) => figure.id === state.id) + by];
    const keep = (machine) => (next.machines.includes(machine) ? machine : "");
    return next && {
      ...state, id: next.id, machine: keep(state.machine), other: keep(state.other), centre: null, at: null, zoom: 0,
      panel: 0, beside: 0, crop: null, how: state.beside || state.how === "panels" ? "one" : state.how, ...(state.beside ? { against: "" } : {}),
    };
  }
  function link(anchor, next, text) {
    anchor.hidden = !next;
    if (next) {
      anchor.href = addressOf(next);
      anchor.textContent = text(next.id);
      anchor.title = FIGURES.get(next.id).title;
    }
  }

  function update(next) {
    const isNew = !state || state.id !== next.id;
    state = next;
    hint.hidden = true;
    const figure = FIGURES.get(state.id);
    title.replaceChildren(el("span", {}, figure.id), ` ${figure.title}`);
    up.href = addressOf({ ...state, id: "" });
    link(before, step(-1), (id) => `\u2190 ${id}`);
    link(after, step(1), (id) => `${id} \u2192`);
    if (isNew) {
      failures.replaceChildren();
      bottom.replaceChildren();
      strip.show([], 1);
      [lensOn, followed] = [false, null];
    }
    lensOn ||= Boolean(state.at);
    load(state);
    element.classList.toggle("unread", !model || model.record.id !== state.id);
    if (!model || model.record.id !== state.id) return stage.show(null, state);
    state = { ...state, ...shownInstead() };
    stage.show(model, { ...state, layers: layers(), how: { pair: "panes", panels: "panes", wipe: "wipe" }[state.how] || "one", crop: rectangle() });
    updateBars();
    showLoupe();
    showStrip();
  }
  // What an address asks for and this figure has not on its machines is left out.
  function shownInstead() {
    const { available: views, panels: { length } } = model, changes = {};
    if (!views.includes(state.view)) changes.view = "machine";
    if (state.panel > length) changes.panel = 0;
    if (state.beside > length) changes.beside = 0;
    const now = { ...state, ...changes };
    const isPair = ["wipe", "pair", "minus"].includes(now.how), beside = now.beside || now.panel;
    const isWrong = isPair && (!views.includes(now.against) || (now.against === now.view && beside === now.panel) || (!now.panel && now.beside) ||
      (now.how === "minus" && (VIEWS[now.view].from || VIEWS[now.against].from)));
    if (isWrong || (now.how === "panels" && length < 2)) changes.how = "one";
    return changes;
  }

  // ---------------------------------------------------------------------------------------------------- keys

  // Whether a key was one of this page's.
  function key(event) {
    const view = Object.keys(VIEWS).find((name) => VIEWS[name].key === event.key && name !== "other");
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const panel = event.shiftKey && /^Digit\d$/.test(event.code || "") ? Number(event.code[5]) : null;
    const compared = Object.keys(HOW).find((name) => HOW[name][1] === event.key);
    if (panel !== null) choosePanel(panel);
    else if (view) chooseView(view);
    else if (compared) compare(compared);
    else if (arrows && (state.at || (lensOn && followed))) movePoint(arrows, event.shiftKey ? 16 : 1);
    else if (arrows && event.shiftKey && model && state.zoom) set({ centre: stage.panBy(-arrows[0] * 80, -arrows[1] * 80) });
    else if (arrows && arrows[0]) {
      const next = step(arrows[0]);
      if (next) go(next);
    } else if (arrows && model) nextMachine(arrows[1]);
    else if (event.key === "Escape") return escaped();
    else {
      const action = {
        "+": () => stage.zoomBy(1), "=": () => stage.zoomBy(1), "-": () => stage.zoomBy(-1),
        0: () => set({ zoom: 0, centre: null }), b: flip, l: toggleLens, x: toggleCrop,
        d: goToLargest, v: () => loupe.say(), t: () => set({ labels: !state.labels }), s: savePicture, S: saveView,
        "[": () => gainBy(0.5), "]": () => gainBy(2), c: cycleMode, f: () => set({ tone: state.tone ? "" : "false" }),
        e: () => set({ exposure: (state.exposure + 1) % 7 }), E: () => set({ exposure: (state.exposure + 6) % 7 }),
        ",": () => choosePanel((state.panel + model.panels.length) % (model.panels.length + 1)),
        ".": () => choosePanel((state.panel + 1) % (model.panels.length + 1)),
      }[event.key];
      if (!action) return false;
      if (model) action();
    }
    return true;
  }
  function movePoint([dx, dy], by) {
    const [x, y] = state.at || followed.at;
    const at = stage.within([x + dx * by, y + dy * by]);
    isPinnedByDefault = false;
    set({ at, ...(state.zoom ? { centre: at } : {}) });
  }
  function cycleMode() {
    const modes = Object.keys(MODES);
    set({ mode: modes[(modes.indexOf(state.mode) + 1) % modes.length] });
  }
  function escaped() {
    if (lensOn) {
      [lensOn, followed] = [false, null];
      set({ at: null });
    } else go({ ...state, id: "" });
    return true;
  }
  return { element, title, update, key };
}
