// The start: thumbnails by paper, a search box and chips.

function thumbnail(figure) {
  const address = `pictures/${figure.thumbnail}`;
  const wide = figure.width / figure.height;
  return el("span", { class: "thumbnail", style: `--panels: ${figure.panels}; aspect-ratio: ${figure.width} / ${figure.height}` },
    figure.thumbnail && el("img", {
      src: `${address}-480.webp`, srcset: `${address}-480.webp 480w, ${address}.webp 960w`,
      sizes: `min(100vw, ${Math.round(Math.max(1, wide) * 150)}px)`,
      loading: "lazy", decoding: "async", alt: "", width: figure.width, height: figure.height,
    }));
}

function cardOf(figure, state) {
  const address = addressOf({ ...state, id: figure.id, view: "" });
  const wide = Math.max(1, figure.width / figure.height);
  const machines = figure.machines.length;
  return el("li", { class: "card", style: `--wide: ${wide}` },
    el("a", { href: address, "data-id": figure.id },
      thumbnail(figure),
      el("span", { class: "name" }, el("b", {}, figure.id), " ", figure.title),
      figure.failures.map((what) => el("span", { class: "facts failed failure" }, what)),
      el("span", { class: "facts" },
        figure.animation ? "in motion \u00b7 " : "",
        machines === 1 ? machineName(figure.machines[0]) : machines ? `${machines} machines` : "",
        figure.machines_differ ? ", differ" : machines > 1 ? ", same bits" : "",
        figure.failed ? el("span", { class: "failed" }, ` · ${figure.failed} failed`) : "")));
}

function paperHeading(key, count) {
  const paper = INDEX.papers[key];
  return el("header", {},
    el("h2", {}, paper.title || key),
    el("p", { class: "quiet" }, paper.cited, ` \u00b7 ${count} figure${count === 1 ? "" : "s"}`));
}

function makeGrid(set) {
  const search = el("input", {
    type: "search", id: "search", autocomplete: "off", spellcheck: "false",
    placeholder: "words, ids, techniques, machines", "aria-keyshortcuts": "/",
    oninput: () => set({ q: search.value }),
  });
  const count = el("p", { class: "count", role: "status", "aria-live": "polite" });
  const sections = el("div", { class: "papers" });
  const chips = [];

  function chip(text, isOn, toggled, title) {
    const button = el("button", { type: "button", class: "chip", title, onclick: () => set(toggled(button.state)) }, text);
    chips.push({ button, isOn });
    return button;
  }
  function group(name, ...buttons) {
    return el("div", { class: "chips", role: "group", "aria-label": name }, el("span", { class: "of" }, name), buttons);
  }
  const toggle = (key, value) => (state) => ({
    [key]: state[key].includes(value) ? state[key].filter((one) => one !== value) : [...state[key], value],
  });
  const counted = (key, value) => INDEX.figures.filter((figure) => figure[key].includes(value)).length;
  const all = (key) => [...new Set(INDEX.figures.flatMap((figure) => figure[key]))];
  const many = (value) => el("span", { class: "many" }, ` ${value}`);

  const machines = Object.keys(INDEX.machines).filter((key) => counted("machines", key)).map((key) =>
    chip([machineName(key), many(counted("machines", key))], (s) => s.machines.includes(key), toggle("machines", key), key));
  const methods = all("methods").sort((a, b) => counted("methods", b) - counted("methods", a)).map((name) =>
    chip([name, many(counted("methods", name))], (s) => s.methods.includes(name), toggle("methods", name)));
  const papers = [...new Set(INDEX.figures.map((figure) => figure.paper))].map((key) =>
    chip([INDEX.papers[key].short, many(INDEX.figures.filter((f) => f.paper === key).length)],
      (s) => s.paper === key, (s) => ({ paper: s.paper === key ? "" : key }), INDEX.papers[key].title));
  const techniques = all("techniques").sort().map((id) =>
    chip([el("b", {}, id), ` ${techniqueName(id)}`, many(counted("techniques", id))], (s) => s.techniques.includes(id), toggle("techniques", id)));
  const flags = [
    chip("machines differ", (s) => s.differ, (s) => ({ differ: !s.differ }), "not all machines of the figure draw the same bits"),
    chip("failed", (s) => s.failed, (s) => ({ failed: !s.failed }), "a check failed, or a machine did not draw the figure"),
  ];
  const methodList = el("details", { class: "methods" }, el("summary", {}, "Methods"), group("method", methods));
  const techniqueList = el("details", { class: "methods" }, el("summary", {}, "Techniques"), group("technique", techniques));
  const clear = el("button", {
    type: "button", class: "plain",
    onclick: () => set(Object.fromEntries(OF_GRID.map((key) => [key, DEFAULTS[key]]))),
  }, "Show all");

  const element = el("div", { class: "grid" },
    el("form", { class: "filters", role: "search", onsubmit: (event) => event.preventDefault() },
      el("div", { class: "find" }, el("label", { for: "search" }, "Find"), search, count, clear),
      group("paper", papers), group("machine", machines), group("only", flags), methodList, techniqueList),
    sections);

  function update(state) {
    const found = matches(state);
    if (search.value !== state.q) search.value = state.q;
    for (const { button, isOn } of chips) {
      button.state = state;
      button.setAttribute("aria-pressed", String(isOn(state)));
    }
    if (state.methods.length) methodList.open = true;
    if (state.techniques.length) techniqueList.open = true;
    const isAll = found.length === FIGURES.size;
    count.textContent = isAll ? `${found.length} figures` : `${found.length} of ${FIGURES.size} figures`;
    clear.hidden = OF_GRID.every((key) => written(state[key]) === written(DEFAULTS[key]));
    const byPaper = groupBy(found, (f) => f.paper);
    sections.replaceChildren(
      ...(state.missing ? [el("p", { class: "nothing" }, `There is no figure ${state.missing} in this gallery. Here are those that there are; fixedpipe figures ID adds one.`)] : []),
      ...[...byPaper].map(([key, figures]) =>
        el("section", { "aria-label": INDEX.papers[key].title || key }, paperHeading(key, figures.length),
          el("ul", { class: "cards" }, figures.map((figure) => cardOf(figure, state)),
            el("li", { class: "rest", "aria-hidden": "true" })))),
      ...(found.length ? [] : [el("p", { class: "nothing" }, "No figure matches. Remove a word or a chip.")]));
  }
  return { element, update, search };
}

function groupBy(items, keyOf) {
  const groups = new Map();
  for (const item of items) groups.set(keyOf(item), [...(groups.get(keyOf(item)) || []), item]);
  return groups;
}
