// A figure's page: its bar, the stage with its bars, and what stands below it.

function makeFigure(set, go, announce) {
  const loupe = makeLoupe(announce);
  const stage = makeStage(set, pointed);
  let state = null, model = null, wanted = "";
  // The loupe is at state.at where it is pinned: by a click, a key or the address. Else it follows the cursor.
  let lensOn = false, followed = null, isPinnedByDefault = false;

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
    loupe.show(model, state, where?.at, where?.event);
  };

  const button = (text, key, onclick, attributes = {}) =>
    el("button", { type: "button", "aria-keyshortcuts": key, title: key ? `${attributes.title || text} (${key})` : text, onclick},
      text, key && key.length === 1 ? el("kbd", { "aria-hidden": "true" }, key) : null);
  const choice = (name, onchange) => el("select", { "aria-label": name, onchange });
  const bar = (name, ...children) => el("div", { class: "bar", role: "group", "aria-label": name }, children);

  const title = el("h1", { tabindex: -1 });
  const before = el("a", { class: "step", "aria-keyshortcuts": "ArrowLeft" }), after = el("a", { class: "step", "aria-keyshortcuts": "ArrowRight" });
  const up = el("a", { class: "step", "aria-keyshortcuts": "Escape" }, "All figures");
  const machine = choice("Machine", () => set({ machine: machine.value }));
  const other = choice("Machine B", () => set({ other: other.value, ...(other.value ? {} : plainly()) }));
  const against = choice("Beside it", () => set({ against: against.value }));
  const viewBar = bar("View"), status = el("p", { class: "status", id: "status" });
  const how = Object.fromEntries([["wipe", "w"], ["pair", "p"]].map(([name, key]) => [name, button(name, key, () => compare(name))]));
  const gain = el("input", { type: "range", min: 0, max: 7, step: 1, "aria-label": "Gain of the difference", oninput: () => set({ gain: 2 ** Number(gain.value) }) });
  const gainText = el("output", {}), mode = choice("Difference shown", () => set({ mode: mode.value }));
  mode.append(...Object.entries(MODES).map(([value, text]) => el("option", { value }, text)));
  const legend = el("span", { class: "legend", "aria-hidden": "true" }, el("i"));
  const gainBar = bar("Difference", el("label", { class: "gain" }, "gain", gain, gainText), mode, legend);
  const zoomText = el("output", { class: "zoom", "aria-live": "off" });
  const lens = button("loupe", "l", () => toggleLens());
  const labels = button("labels", "t", () => set({ labels: !state.labels }));
  const largest = button("largest difference", "d", () => goToLargest());
  const say = button("say pixel", "v", () => loupe.say());
  const bottom = el("div", { class: "below" });
  const failure = el("p", { class: "failed", role: "alert", hidden: true });
  const failures = el("div", { class: "failures" });

  const element = el("article", { class: "figure" },
    el("nav", { "aria-label": "Figures" }, up, el("span", { class: "steps" }, before, after)),
    title,
    el("div", { class: "bars" },
      bar("Machine", el("label", {}, el("span", { class: "of" }, "machine A"), machine), el("label", {}, el("span", { class: "of" }, "B"), other)),
      viewBar,
      bar("Beside", how.wipe, how.pair, el("label", {}, el("span", { class: "of" }, "with"), against))),
    failures, failure,
    el("div", { class: "frame" }, stage.element, loupe.element),
    el("div", { class: "bars under" },
      bar("Zoom", button("\u2212", "", () => stage.zoomBy(-1), { title: "smaller" }), zoomText, button("+", "", () => stage.zoomBy(1)),
        button("fit", "0", () => set({ zoom: 0, centre: null })), button("1:1", "", () => set({ zoom: 1 }))),
      gainBar,
      bar("Look", largest, lens, say, labels, button("save PNG", "s", save))),
    status, bottom);
  element.querySelectorAll(".bar button").forEach((one) => {
    if (one.textContent === "\u2212") one.setAttribute("aria-label", "smaller");
    if (one.textContent === "+") one.setAttribute("aria-label", "larger");
  });

  // Without B nothing of B is shown.
  const plainly = () => ({
    view: ["other", "other_difference"].includes(state.view) ? "machine" : state.view,
    ...(["other", "other_difference"].includes(state.against) ? { how: "one", against: "" } : {}),
  });

  function partner() {
    const choices = model.available.filter((view) => view !== state.view);
    return choices.includes("other") ? "other" : choices.find((view) => view === "ideal") || choices[0];
  }
  function compare(name) {
    if (!model) return;
    if (state.how === name) return set({ how: "one", against: "" });
    const beside = state.against && state.against !== state.view ? state.against : partner();
    if (beside) set({ how: name, against: beside });
  }
  function chooseView(view) {
    if (!model?.available.includes(view)) return;
    // Flipping to what is beside it changes places.
    set({ view, ...(state.against === view ? { against: state.view } : {}) });
  }
  function flip() {
    if (model?.other) chooseView(state.view === "other" ? "machine" : "other");
  }
  function toggleLens() {
    if (!model) return;
    lensOn = !(lensOn || state.at);
    followed = null;
    isPinnedByDefault = lensOn;
    set({ at: lensOn ? stage.within(state.centre || [model.record.width / 2, model.record.height / 2]) : null });
  }
  function goToLargest() {
    const view = VIEWS[state.view].from ? state.view : model?.differences()[0];
    if (!view) return;
    const { at, identical } = model.numbers(view);
    if (identical || !at) return announce("There is no difference.");
    isPinnedByDefault = false;
    set({ at, centre: at, zoom: Math.max(state.zoom, 8) });
    loupe.say();
  }
  function gainBy(by) {
    const view = VIEWS[state.view].from ? state.view : model?.differences()[0];
    if (view) set({ gain: Math.min(128, Math.max(1, model.gainOf(view, state) * by)) });
  }
  async function save() {
    if (!model) return;
    const address = URL.createObjectURL(await stage.save());
    const name = [state.id, model.drawn.profile, ...(state.view === "machine" ? [] : [state.view.replaceAll("_", "-")])].join("-");
    el("a", { href: address, download: `${name}.png` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 60000); // some browsers read it only now
  }

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
      const beside = record.machines.find((one) => one.profile === next.other && one !== drawn);
      const pictures = await picturesOf(drawn, beside);
      if (key !== wanted) return;
      model = makeModel(record, drawn, beside, pictures);
      failure.hidden = true;
      bottom.replaceChildren(...below(record, drawn, FIGURES.get(next.id), set).filter(Boolean));
      fillMachines(record, drawn, beside);
      update(state);
    } catch (error) {
      if (key !== wanted) return;
      wanted = "";
      failure.textContent = error.message;
      failure.hidden = false;
    }
  }

  function fillMachines(record, drawn, beside) {
    const options = (chosen) => record.machines.map((one) => el("option", { value: one.profile, selected: one === chosen },
      nameOf(one.profile) + (one.same_bits_as ? ` (= ${nameOf(one.same_bits_as)})` : "")));
    machine.replaceChildren(...options(drawn));
    other.replaceChildren(el("option", { value: "", selected: !beside }, "no other"), ...options(beside).filter((o) => o.value !== drawn.profile));
    other.disabled = record.machines.length < 2;
  }

  function updateBars() {
    const shown = state.view;
    viewBar.replaceChildren(...model.available.map((view) => {
      const one = button(VIEWS[view].name, VIEWS[view].key, () => chooseView(view), { title: model.nameOfView(view) });
      one.setAttribute("aria-pressed", String(view === shown));
      one.dataset.view = view;
      return one;
    }));
    against.replaceChildren(...model.available.filter((view) => view !== shown).map((view) =>
      el("option", { value: view, selected: view === state.against }, model.nameOfView(view))));
    against.parentElement.hidden = state.how === "one";
    for (const [name, one] of Object.entries(how)) {
      one.setAttribute("aria-pressed", String(state.how === name));
      one.disabled = model.available.length < 2;
    }
    const difference = [state.view, state.how === "one" ? "" : state.against].find((view) => VIEWS[view]?.from);
    gainBar.hidden = !difference;
    const value = difference ? model.gainOf(difference, state) : 1;
    gain.value = String(Math.log2(value));
    gain.setAttribute("aria-valuetext", `times ${value}`);
    gainText.textContent = `\u00d7 ${value}`;
    mode.value = state.mode;
    legend.hidden = state.mode !== "color";
    legend.dataset.most = fourDigits(1 / value);
    labels.setAttribute("aria-pressed", String(state.labels));
    labels.hidden = !model.record.panels.some((panel) => panel.label);
    lens.setAttribute("aria-pressed", String(lensOn));
    largest.disabled = !model.differences().length;
    zoomText.textContent = stage.scaleInWords();
    const { drawn, record } = model;
    const caption = shown.startsWith("other") ? model.nameOfView(shown)
      : VIEWS[shown].from ? `${model.nameOfView(shown)}, \u00d7 ${model.gainOf(shown, state)}${{ signed: " about middle grey", absolute: " on black", color: ", the largest component" }[state.mode]}` : drawn.pictures[shown].caption;
    const same = record.machines.filter((one) => one.same_bits_as === drawn.profile).map((one) => nameOf(one.profile));
    status.replaceChildren(...(shown === "machine" || VIEWS[shown].from || shown === "other" ? [] : [el("b", {}, VIEWS[shown].name), ": "]), `${caption}. `,
      `${record.width} \u00d7 ${record.height} pixels`, drawn.bits ? `, ${drawn.bits} bits a component` : "", ". ",
      drawn.same_bits_as ? `The same bits as ${nameOf(drawn.same_bits_as)}. ` : same.length ? `The same bits on ${same.join(", ")}. ` : "");
  }

  function step(by) {
    const found = matches(state), list = found.some((f) => f.id === state.id) ? found : [...FIGURES.values()];
    const next = list[list.findIndex((figure) => figure.id === state.id) + by];
    return next && { ...state, id: next.id, machine: next.machines.includes(state.machine) ? state.machine : "", other: next.machines.includes(state.other) ? state.other : "", centre: null, at: null, zoom: 0 };
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
    const figure = FIGURES.get(state.id);
    title.replaceChildren(el("span", {}, figure.id), ` ${figure.title}`);
    up.href = addressOf({ ...state, id: "" });
    link(before, step(-1), (id) => `\u2190 ${id}`);
    link(after, step(1), (id) => `${id} \u2192`);
    if (isNew) {
      failures.replaceChildren();
      bottom.replaceChildren();
      [lensOn, followed] = [false, null];
    }
    lensOn ||= Boolean(state.at);
    load(state);
    if (!model || model.record.id !== state.id) return stage.show(null, state);
    const views = model.available;
    // What an address asks for and this machine has not is left out.
    if (!views.includes(state.view)) state = { ...state, view: "machine" };
    if (!views.includes(state.against) || state.against === state.view) state = { ...state, how: "one" };
    stage.show(model, state);
    updateBars();
    showLoupe();
  }

  // Whether a key was one of this page's.
  function key(event) {
    const view = Object.keys(VIEWS).find((name) => VIEWS[name].key === event.key && name !== "other");
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (view) chooseView(view);
    else if (arrows && (state.at || (lensOn && followed))) movePoint(arrows, event.shiftKey ? 16 : 1);
    else if (arrows && event.shiftKey && model && state.zoom) set({ centre: stage.panBy(-arrows[0] * 80, -arrows[1] * 80) });
    else if (arrows && arrows[0]) {
      const next = step(arrows[0]);
      if (next) go(next);
    }
    else if (event.key === "Escape") return escaped();
    else {
      const action = {
        "+": () => stage.zoomBy(1), "=": () => stage.zoomBy(1), "-": () => stage.zoomBy(-1),
        0: () => set({ zoom: 0, centre: null }), w: () => compare("wipe"), p: () => compare("pair"), b: flip, l: toggleLens,
        d: goToLargest, v: () => loupe.say(), t: () => set({ labels: !state.labels }), s: save,
        "[": () => gainBy(0.5), "]": () => gainBy(2), c: cycleMode,
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
