// The bars around the stage: machines, layers, zoom, exposure, tools, what is kept.

const KEYS = [
  ["1 2 3 4", "machine, ideal, reference, difference"], ["5", "difference from the reference"], ["b, 6", "machine B, and A \u2212 B"],
  ["w, p", "divider between two, pair"], ["i, o, q", "a drag turns the light, the camera, or only looks"],
  ["arrows", "turn by five degrees; of a marked pixel: move it, with Shift by 16"], ["Enter", "history of the marked pixel"],
  ["+ \u2212 0", "zoom, fit"], ["l", "loupe"], ["v", "say the pixel\u2019s numbers"], [", .", "a command back, on"],
  ["[ ]", "gain of the difference"], ["c", "signed, absolute, false color"], ["e, Shift e", "exposure up, down"],
  ["z, y", "undo, redo"], ["s", "save the script"], ["Esc", "unmark the pixel"], ["?", "these keys"],
];

const bar = (name, ...children) => el("div", { class: "bar", role: "group", "aria-label": name }, children);
const button = (text, key, onclick, title = text) =>
  el("button", { type: "button", "aria-keyshortcuts": key || null, title: key ? `${title} (${key})` : title, onclick },
    text, key && key.length === 1 ? el("kbd", { "aria-hidden": "true" }, key) : null);
const choice = (name, onchange) => {
  const made = el("select", { "aria-label": name, onchange: () => onchange(made.value) });
  return made;
};
function fill(select, options, chosen) {
  const key = JSON.stringify(options);
  if (select.dataset.options !== key) {
    select.dataset.options = key;
    select.replaceChildren(...options.map(([value, text]) => el("option", { value }, text)));
  }
  select.value = chosen;
}

function makeTheme(root) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const made = el("button", { type: "button", class: "plain", onclick() {
    root.dataset.theme = isDark() ? "light" : "dark";
    name();
  } });
  const name = () => {
    made.textContent = isDark() ? "Light" : "Dark";
    made.setAttribute("aria-label", `${made.textContent} colors`);
  };
  system.addEventListener("change", name);
  name();
  return made;
}

// act: {machine, other, against, shown, compare, gain, mode, exposure, tool, zoomBy, zoom, lens, say, keep, undo, redo, size}
function makeBars(act) {
  const machine = choice("Machine", act.machine), other = choice("Machine B", act.other), against = choice("Beside it", act.against);
  const layers = bar("View"), tools = bar("A drag turns");
  const how = { wipe: button("divider", "w", () => act.compare("wipe")), panes: button("pair", "p", () => act.compare("panes")) };
  const againstBox = el("label", {}, el("span", { class: "of" }, "with"), against);
  const gain = el("input", { type: "range", min: 0, max: 7, step: 1, "aria-label": "Gain of the difference", oninput: () => act.gain(2 ** Number(gain.value)) });
  const gainText = el("output", {}), mode = choice("Difference shown", act.mode);
  fill(mode, Object.entries(MODES), "signed");
  const gainBar = bar("Difference", el("label", { class: "gain" }, "gain", gain, gainText), mode);
  const exposure = el("input", { type: "range", min: -4, max: 4, step: 0.5, "aria-label": "Exposure, stops", oninput: () => act.exposure(Number(exposure.value)) });
  const exposureText = el("output", {}), zoomText = el("output", { class: "zoom" });
  const size = choice("Size of a panel", (text) => act.size(Number(text)));
  const lens = button("loupe", "l", act.lens), undo = button("undo", "z", act.undo), redo = button("redo", "y", act.redo);
  const zoomOut = button("\u2212", "", () => act.zoomBy(-1), "smaller"), zoomIn = button("+", "", () => act.zoomBy(1), "larger");
  zoomOut.setAttribute("aria-label", "smaller");
  zoomIn.setAttribute("aria-label", "larger");

  return {
    above: el("div", { class: "bars" },
      bar("Machines", el("label", {}, el("span", { class: "of" }, "machine"), machine), el("label", {}, el("span", { class: "of" }, "B"), other)),
      layers, bar("Beside", how.wipe, how.panes, againstBox)),
    under: el("div", { class: "bars under" },
      tools, bar("Undo", undo, redo),
      bar("Zoom", zoomOut, zoomText, zoomIn, button("fit", "0", () => act.zoom(0)), button("1:1", "", () => act.zoom(1)), el("label", {}, el("span", { class: "of" }, "size"), size)),
      bar("Look", lens, button("say pixel", "v", act.say)),
      bar("Exposure", el("label", { class: "gain" }, "exposure", exposure, exposureText)), gainBar),
    keep: bar("Keep", button("script", "s", () => act.keep("script"), "save the frame as Python"), button("picture", "", () => act.keep("picture"), "save the machine's picture as PNG"),
      button("golden test", "", () => act.keep("golden"), "save a pytest test with this as its golden picture"), button("link", "", () => act.keep("link"), "copy this view's address")),
    show({ state, model, tool, isLens, canUndo, canRedo, names, scale }) {
      const { about } = model;
      const machines = about ? about.machines : [state.view.machine];
      fill(machine, machines.map((key) => [key, names[key] || key]), state.view.machine);
      fill(other, [["", "no other"], ...machines.map((key) => [key, key === state.view.machine ? `${names[key]}, as built` : names[key] || key])], state.other);
      const available = model.available().filter((name) => !["other", "other_difference"].includes(LAYERS[name].from || name) || state.other);
      const key = available.join();
      if (layers.dataset.has !== key) {
        layers.dataset.has = key;
        layers.replaceChildren(...available.map((name) => {
          const made = button(LAYERS[name].name, LAYERS[name].key, () => act.shown(name));
          made.dataset.view = name;
          return made;
        }));
      }
      for (const made of layers.children) made.setAttribute("aria-pressed", String(made.dataset.view === state.shown));
      fill(against, available.filter((name) => name !== state.shown).map((name) => [name, LAYERS[name].name]), state.against);
      againstBox.hidden = state.how === "one";
      for (const [name, made] of Object.entries(how)) made.setAttribute("aria-pressed", String(state.how === name));
      const can = about ? toolsOf(about.controls) : ["look"];
      if (tools.dataset.has !== can.join()) {
        tools.dataset.has = can.join();
        tools.replaceChildren(el("span", { class: "of" }, "a drag turns"), ...can.map((name) => {
          const made = button(name === "look" ? "nothing" : TOOLS[name].name, TOOLS[name].key, () => act.tool(name));
          made.dataset.tool = name;
          return made;
        }));
      }
      tools.hidden = can.length < 2;
      for (const made of tools.querySelectorAll("button")) made.setAttribute("aria-pressed", String(made.dataset.tool === tool));
      const difference = [state.shown, state.how === "one" ? "" : state.against].find((name) => LAYERS[name]?.from && model.has(LAYERS[name].from));
      gainBar.hidden = !difference;
      const by = difference ? state.gain || model.numbersOf(difference).gain : 1;
      gain.value = String(Math.log2(by));
      gain.setAttribute("aria-valuetext", `times ${by}`);
      gainText.textContent = `\u00d7 ${by}`;
      mode.value = state.mode;
      exposure.value = String(state.exposure);
      exposureText.textContent = `${state.exposure > 0 ? "+" : ""}${state.exposure}`.replace("-", "\u2212");
      exposure.setAttribute("aria-valuetext", `${state.exposure} stops`);
      zoomText.textContent = scale;
      lens.setAttribute("aria-pressed", String(isLens));
      [undo.disabled, redo.disabled] = [!canUndo, !canRedo];
      const sizes = about ? [...new Set([128, 256, 384, 512, 768, 1024, about.size, state.view.size || about.size])].sort((a, b) => a - b) : [];
      fill(size, sizes.map((n) => [n, `${n}`]), state.view.size || about?.size);
      size.disabled = !about?.sizable;
    },
  };
}
