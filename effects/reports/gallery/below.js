// What stands below the stage: what is to be seen beside what was measured, and how it was made.

async function copied(text, button) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // A page opened from a file may have no clipboard: by a selection, as pages did before.
    const area = el("textarea", { class: "away" }, text);
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
    button.focus();
  }
  button.textContent = "Copied";
  button.addEventListener("blur", () => { button.textContent = "Copy"; }, { once: true });
}

function copyable(name, text) {
  const button = el("button", { type: "button", class: "plain copy", "aria-label": `Copy ${name}`, onclick: () => copied(text, button) }, "Copy");
  return el("div", { class: "copyable" }, el("pre", {}, text), button);
}

const section = (title, name, ...children) =>
  el("section", { class: name }, el("h2", {}, title), children);

// A sentence of the must-see, and the checks that fail where it is untrue.
function sentenceOf(sentence, number, rows) {
  const found = rows.filter((row) => (row.machine || row.ideal).must_see?.includes(number));
  if (!found.length) return el("li", {}, sentence);
  const ofChecks = found.map((row) => {
    const verdicts = [row.ideal, row.machine].filter((check) => check), passed = verdicts.every((check) => check.passed);
    return el("li", {}, row.name, " ", el("span", { class: passed ? "ok" : "failed" }, passed ? "ok" : "failed"));
  });
  const title = found.length === 1 ? "1 check" : `${found.length} checks`;
  return el("li", {}, sentence, el("details", { class: "quiet" }, el("summary", {}, title), el("ul", {}, ofChecks)));
}

function mustSee(record, drawn, figure) {
  if (record.set) {
    const changed = Object.entries(record.set).map(([name, value]) => `${name} = ${JSON.stringify(value)}`).join(", ");
    return section(`A variant of ${record.figure}`, "must-see", el("p", {}, `${changed}. What must be seen, and what is checked, is of the figure\u2019s own values.`));
  }
  return section("Must be seen", "must-see", el("ul", { class: "checklist" },
    figure.must_see.map((sentence, place) => sentenceOf(sentence, place + 1, drawn ? checksOf(record, drawn) : []))));
}

// The checks of a machine, and those of the ideal, which are with the first machine that draws in the same
// way. What is checked of both stands in one row.
function checksOf(record, drawn) {
  const first = record.machines.find((other) => other.method === drawn.method);
  const rows = new Map();
  const every = [...first.checks.filter((check) => check.on === "ideal"), ...drawn.checks.filter((check) => check.on !== "ideal")];
  for (const check of every) {
    const key = `${check.name} ${check.relation} ${check.bound}`;
    rows.set(key, { ...(rows.get(key) || { name: check.name, relation: check.relation, bound: check.bound, reason: check.reason }), [check.on]: check });
  }
  return [...rows.values()];
}

function verdict(check) {
  if (!check) return el("td", { class: "number" });
  return el("td", { class: "number" },
    el("span", { class: check.passed ? "ok" : "failed" }, check.passed ? "ok" : "failed"), ` ${fourDigits(check.value)}`);
}

function measured(record, drawn) {
  const rows = checksOf(record, drawn);
  if (!rows.length) {
    return section("Measured", "measured", el("p", { class: "quiet" }, record.set
      ? "A variant is not checked." : "Not checked. The command below checks it where --check is added."));
  }
  const failed = rows.filter((row) => [row.ideal, row.machine].some((check) => check && !check.passed)).length;
  return section("Measured", "measured",
    el("p", { class: "summary" }, failed ? el("span", { class: "failed" }, `${failed} of ${rows.length} failed`) : el("span", { class: "ok" }, `all ${rows.length} checks passed`)),
    el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "checks" }, el("table", {},
      el("thead", {}, el("tr", {}, ["check", "ideal", machineName(drawn.profile), "bound"].map((h) => el("th", { scope: "col" }, h)))),
      el("tbody", {}, rows.map((row) => el("tr", {},
        el("th", { scope: "row" }, row.name, el("span", { class: "reason" }, row.reason)),
        verdict(row.ideal), verdict(row.machine),
        el("td", { class: "number" }, `${row.relation === "<=" ? "\u2264" : "\u2265"} ${fourDigits(row.bound)}`)))))));
}

function machineTable(record, drawn, set) {
  const number = (text) => el("td", { class: "number" }, text);
  return section("Machines", "machines", el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "machines" }, el("table", {},
    el("thead", {}, el("tr", {}, ["machine", "key", "draws it by", "bits", "RMS", "largest", "pixels that differ", "FLIP"].map((h) => el("th", { scope: "col" }, h)))),
    el("tbody", {}, record.machines.map((one) => {
      const { difference } = one, flip = typeof difference?.flip === "number" ? fourDigits(difference.flip) : "";
      const name = el("button", { type: "button", class: "link", "aria-current": one === drawn ? "true" : null, onclick: () => set({ machine: one.profile }) }, machineName(one.profile));
      const begin = [el("th", { scope: "row" }, name), el("td", {}, el("code", {}, one.profile)), el("td", {}, one.method), number(one.bits ?? "")];
      if (one.same_bits_as) return el("tr", {}, begin, el("td", { colspan: 4 }, `the same bits as ${machineName(one.same_bits_as)}`));
      if (!difference) return el("tr", {}, begin, el("td", { colspan: 4 }, ""));
      if (difference.identical) return el("tr", {}, begin, number(difference.rms.toExponential(1)), number(fourDigits(difference.max)), number("identical"), number(flip));
      return el("tr", {}, begin, number(fourDigits(difference.rms)), number(fourDigits(difference.max)), number(difference.pixels.toLocaleString("en")), number(flip));
    })))),
    el("p", { class: "quiet" }, "RMS and largest difference from the unrounded ideal, 1 = full intensity; pixels that differ from the ideal rounded to the machine\u2019s bits; FLIP, from 0 to 1, as an eye sees the two pictures flipped (Andersson and others 2020)."));
}

function passesOf(record, drawn) {
  const first = record.machines.find((one) => one.method === drawn.method && one.passes);
  const passes = (Array.isArray(record.passes) ? record.passes : record.passes?.[first?.profile] || record.passes?.[drawn.method]) || first?.passes || [];
  if (!passes.length) return null;
  const { length } = passes, all = first?.commands;
  const said = all > length ? `${length} of ${all.toLocaleString("en")} commands are shown: those after which the picture changes most. Numbers count the commands from 0.` : "After each command that changes the picture. Numbers count the commands from 0.";
  return section("Passes", "passes", el("p", { class: "quiet" }, said),
    el("ol", {}, passes.map((pass) => el("li", {},
      el("a", { href: `pictures/${pass.preview}.webp`, target: "_blank" },
        el("img", { src: `pictures/${pass.preview}.webp`, loading: "lazy", decoding: "async", alt: `after command ${pass.number}`, width: record.width, height: record.height })),
      el("p", {}, el("b", {}, pass.number), ` ${pass.label}`),
      pass.commands ? el("details", {}, el("summary", {}, "Commands since the picture before"), el("pre", {}, [pass.commands].flat().join("\n"))) : null))));
}

// The figure in motion; its file is read when it is asked for.
function motionOf(record) {
  const { animation } = record;
  if (!animation) return null;
  const { digest, does, frames, width, height, bytes } = animation;
  const place = el("div", { class: "motion" });
  const play = el("button", { type: "button", class: "plain", "aria-pressed": "false", onclick() {
    const isOn = !place.childElementCount;
    place.replaceChildren(...(isOn ? [el("img", { src: `pictures/${digest}.webp`, width, height, alt: `${record.id}: ${does}` })] : []));
    play.textContent = isOn ? "Stop" : "Play";
    play.setAttribute("aria-pressed", String(isOn));
  } }, "Play");
  return section("In motion", "in-motion",
    el("p", {}, play, ` ${does}: ${frames} frames of ${width} \u00d7 ${height} pixels, ${Math.round(bytes / 1000)} kB. `,
      el("span", { class: "quiet" }, `Compressed with losses; fixedpipe animate ${record.id} writes it without.`)), place);
}

function parametersOf(record, drawn) {
  const values = Object.entries({ ...record.parameters, ...drawn.parameters, ...record.set });
  if (!values.length) return null;
  return section("Parameters", "parameters", el("dl", {}, values.flatMap(([name, value]) =>
    [el("dt", {}, name), el("dd", {}, value === null ? "none" : typeof value === "string" ? value : JSON.stringify(value).replaceAll(",", ", "))])));
}

// An id with what it means, and where that is said.
function technique(id) {
  const { name, page } = INDEX.techniques[id] || {};
  const said = [el("b", {}, id), name ? ` ${name}` : ""];
  return el("li", {}, page ? el("a", { href: page }, said) : said, " ",
    el("a", { class: "quiet", href: addressOf({ ...DEFAULTS, techniques: [id] }) }, "figures"));
}
function sources(record) {
  const { citation } = record;
  return section("Source", "source",
    el("p", {}, citation.title, ". ", INDEX.papers[record.source].cited),
    el("ul", { class: "techniques" }, record.techniques.map(technique)),
    el("p", { class: "quiet" }, INDEX.pages[record.id] ? el("a", { href: INDEX.pages[record.id] }, "what the paper shows, and what is expected of the picture") : null,
      INDEX.pages[record.id] ? " \u00b7 " : "", el("a", { href: `${encodeURIComponent(record.id)}.json` }, "all numbers (JSON)")),
    citation.bibtex ? el("details", {}, el("summary", {}, "BibTeX"), copyable("BibTeX", citation.bibtex)) : null);
}

// What could not be drawn or checked, and where in the program it happened.
function failuresOf(record, figure) {
  const traces = new Map((record.failures || []).filter((one) => one.trace).map((one) => [one.what, one.trace]));
  return [
    ...figure.failures.map((sentence) => el("p", { class: "failed" }, sentence)),
    ...[...traces].map(([what, trace]) =>
      el("details", {}, el("summary", {}, `Where it happened: ${what}`), copyable("the trace", trace))),
  ];
}

// `drawn`: the machine that is shown; null where none drew the figure.
function below(record, drawn, figure, set) {
  const again = record.command ? section("Draw it again", "command", copyable("the command", record.command)) : null;
  if (!drawn) {
    return [
      el("p", { class: "caption" }, record.caption), mustSee(record, null, figure),
      el("div", { class: "beside" }, el("div", {}, again, sources(record))),
    ];
  }
  return [
    el("p", { class: "caption" }, record.caption),
    el("div", { class: "beside" }, mustSee(record, drawn, figure), measured(record, drawn)),
    motionOf(record),
    machineTable(record, drawn, set),
    passesOf(record, drawn),
    el("div", { class: "beside" },
      el("div", {}, again, sources(record)),
      parametersOf(record, drawn)),
  ];
}
