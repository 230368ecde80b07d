// What stands beside the picture: a pixel's history, the registers, the state of a command, in words.

function makePanels(ask) {
  const history = el("div", { class: "history", tabindex: 0, role: "region", "aria-label": "History of the pixel" });
  const historyOf = el("p", { class: "quiet" }, "Click a pixel, or press Enter on the marked one.");
  const registers = el("div", { class: "scroll" });
  const registersNote = el("p", { class: "quiet" }, "Least, greatest and mean of what every register held, and the shares that were clamped.");
  const measure = el("button", { type: "button", onclick: () => ask("registers") }, "measure registers");

  const number = (value) => (value === null || value === undefined ? "" : fourDigits(value));
  const share = (value) => (value ? `${(100 * value).toFixed(2)} %` : "");
  const COLUMNS = [["command", (r) => r.command], ["stage", (r) => r.stage], ["register", (r) => r.register], ["least", (r) => number(r.least)],
    ["greatest", (r) => number(r.greatest)], ["mean", (r) => number(r.mean)], ["clamped low", (r) => share(r.clamped_low)],
    ["clamped high", (r) => share(r.clamped_high)], ["codes", (r) => `${r.codes} of ${r.of}`], ["bits left", (r) => r.headroom ?? ""]];

  return {
    history: el("div", {}, historyOf, history),
    registers: el("div", {}, registersNote, measure, registers),
    waits(at) {
      historyOf.textContent = `Pixel ${at[0]}, ${at[1]}: drawn again, stage by stage \u2026`;
      history.setAttribute("aria-busy", "true");
    },
    // `html` is the viewer's own, escaped, as `fixedpipe inspect --html` has it.
    showHistory({ html, json }) {
      historyOf.textContent = `${json.touched.length} of ${json.commands} commands touched pixel ${json.x}, ${json.y}.`;
      history.innerHTML = html;
      for (const row of history.querySelectorAll("tr.stage")) row.className = "step"; // the picture is the stage here
      history.removeAttribute("aria-busy");
      history.scrollTop = 0;
    },
    refusedHistory(words) {
      historyOf.textContent = words;
      history.replaceChildren();
      history.removeAttribute("aria-busy");
    },
    measuring() {
      measure.disabled = true;
      measure.textContent = "measuring \u2026";
    },
    showRegisters(rows) {
      measure.disabled = false;
      measure.textContent = "measure again";
      registersNote.textContent = rows.length ? `${rows.length} registers of the whole frame, as it was when it was measured.` : "No Draw of this frame has registers.";
      registers.replaceChildren(el("table", {},
        el("thead", {}, el("tr", {}, COLUMNS.map(([name]) => el("th", { scope: "col" }, name)))),
        el("tbody", {}, rows.map((row) => el("tr", {}, COLUMNS.map(([, cell]) => el("td", {}, String(cell(row)))))))));
    },
    refusedRegisters(words) {
      measure.disabled = false;
      measure.textContent = "measure registers";
      registersNote.textContent = words;
    },
  };
}

// The slider through the commands: number of the last that is drawn; at its end the whole frame.
function makePasses(set) {
  const slider = el("input", { type: "range", min: 0, step: 1, "aria-label": "Commands that are drawn",
    oninput: () => give(false), onchange: () => give(true) });
  const words = el("pre", { class: "words" }), label = el("output", { class: "quiet" });
  let count = 0;
  const upto = (value) => (value >= count ? null : value);
  const give = (isDone) => set(upto(Number(slider.value)), isDone);
  const step = (by) => {
    const next = clamped(Number(slider.value) + by, 0, count);
    set(upto(next), true);
  };
  const button = (text, by, title) => el("button", { type: "button", title, "aria-label": title, onclick: () => step(by) }, text);
  return {
    element: el("div", { class: "passes" }, el("div", { class: "bar" }, button("\u2190", -1, "one command back (,)"), slider, button("\u2192", 1, "one command on (.)")), label, words),
    step,
    show(value, header) {
      count = header?.commands ?? count;
      slider.max = count;
      slider.value = value === null ? count : value;
      const of = value === null ? null : header?.command;
      const said = of && of.number === value ? `after command ${of.number} of ${count}: ${of.kind}, ${of.label}` : value === null ? `all ${count} commands` : `command ${value}`;
      label.textContent = header?.pbuffer && of ? `${said}; it draws to pbuffer ${header.pbuffer}` : said;
      slider.setAttribute("aria-valuetext", said);
      words.hidden = !of;
      words.textContent = of ? of.words.join("\n") : "";
    },
  };
}

// The machine's widths and clamps, as `fixedpipe precision` changes them.
function makePrecision(set) {
  const element = el("div", { class: "precision" });
  const WIDTHS = Array.from({ length: 13 }, (_, n) => n + 4);
  const CLAMPS = { VERTEX_COLOR: "colours of vertices", MAPPING: "inputs of combiners", GENERAL_COMBINER: "outputs of general combiners",
    TEXTURE_ENVIRONMENT: "results of texture environments", COLOR_SUM: "the sum with the secondary colour",
    FINAL_COMBINER: "fragments\u2019 colours in the end", BLENDING: "what blending writes" };
  let built = null, widths = {}, clamps = {};
  function build(about) {
    widths = Object.fromEntries(Object.entries(about.widths).map(([part, own]) => [part,
      el("select", { "aria-label": `bits of ${part.replace("_", " ")}`, onchange: (event) => set({ bits: [part, Number(event.target.value)] }) },
        el("option", { value: 0 }, `its own, ${own}`), WIDTHS.filter((bits) => bits !== own).map((bits) => el("option", { value: bits }, bits)))]));
    clamps = Object.fromEntries(about.clamps.map((name) => [name,
      el("input", { type: "checkbox", onchange: (event) => set({ clamp: [name, event.target.checked] }) })]));
    element.replaceChildren(
      el("div", { class: "widths" }, Object.entries(widths).map(([part, select]) => el("label", {}, el("span", {}, part.replace("_", " ")), select))),
      about.widths.combiner ? el("p", { class: "quiet" }, "Combiners have a sign beside these bits.") : null,
      el("fieldset", {}, el("legend", { class: "quiet" }, "clamps of the machine"),
        Object.entries(clamps).map(([name, box]) => el("label", { class: "check" }, box, el("span", {}, CLAMPS[name] || name)))));
  }
  return {
    element,
    show(about, view) {
      if (built !== about) build(about);
      built = about;
      for (const [part, select] of Object.entries(widths)) select.value = view.bits[part] || 0;
      for (const [name, box] of Object.entries(clamps)) box.checked = !view.without.includes(name);
    },
  };
}
