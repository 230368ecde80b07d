// A subject's parameters as sliders, choices and fields. Values are texts, as --set takes them.
//
// makeControls(set) takes set(name, text, isDone): another value; `isDone`: the hand has let go.

const STEPS = 400; // of a slider whose numbers are not whole

const inWords = (number) => String(+Number(number).toFixed(4));
const numbersIn = (text) => text.split(",").map(Number);

function makeControls(set) {
  const element = el("div", { class: "controls" });
  let rows = [];

  function numberRow(of) {
    const parts = of.parts.map((part, n) => {
      const low = part.power ? Math.log2(part.low || 1) : part.low, high = part.power ? Math.log2(part.high) : part.high;
      const step = part.power ? 1 : part.step || (high - low) / STEPS;
      const label = `${of.name}${part.label ? ` ${part.label}` : of.parts.length > 1 ? ` ${n + 1}` : ""}`;
      const slider = el("input", { type: "range", min: low, max: high, step, "aria-label": label,
        oninput: () => give(n, part.power ? 2 ** slider.value : slider.value, false), onchange: () => give(n, part.power ? 2 ** slider.value : slider.value, true) });
      const field = el("input", { type: "number", step: part.step || "any", "aria-label": `${label}, number`,
        onchange: () => field.value !== "" && give(n, field.value, true) });
      return { part, slider, field };
    });
    let now = [];
    function give(n, value, isDone) {
      set(of.name, now.map((each, k) => inWords(k === n ? value : each)).join(","), isDone);
    }
    return {
      body: parts.map(({ part, slider, field }) => el("span", { class: "part" },
        part.label ? el("span", { class: "axis", "aria-hidden": "true" }, part.label.slice(0, 1)) : null, slider, field)),
      show(text) {
        now = numbersIn(text);
        parts.forEach(({ part, slider, field }, n) => {
          slider.value = part.power ? Math.log2(now[n]) : now[n];
          slider.setAttribute("aria-valuetext", `${inWords(now[n])} ${of.unit}`.trim());
          if (field !== field.getRootNode().activeElement) field.value = inWords(now[n]);
        });
      },
    };
  }
  function choiceRow(of, choices) {
    const select = el("select", { "aria-label": of.name, onchange: () => set(of.name, select.value, true) },
      choices.map((choice) => el("option", { value: choice }, choice)));
    return { body: [select], show(text) { select.value = text; } };
  }
  function textRow(of) {
    const field = el("input", { type: "text", "aria-label": of.name, spellcheck: "false", onchange: () => set(of.name, field.value, true) });
    field.disabled = of.form === "fixed";
    return { body: [field], show(text) { if (field !== field.getRootNode().activeElement) field.value = text; } };
  }
  const MADE = {
    numbers: numberRow,
    choice: (of) => choiceRow(of, of.choices),
    flag: (of) => choiceRow(of, ["True", "False"]),
    text: textRow,
    fixed: textRow,
  };

  function build(controls) {
    rows = controls.map((of) => {
      const row = MADE[of.form](of), id = `of-${of.name}`;
      const reset = el("button", { type: "button", class: "plain reset", title: `${of.name} as it was: ${of.text}`, "aria-label": `${of.name} as it was`,
        onclick: () => set(of.name, null, true) }, "\u21ba");
      const note = `${of.does}${of.of ? ` It takes part beside ${of.of} alone.` : ""} Give ${of.allowed}.`;
      const box = el("div", { class: "control", role: "group", "aria-labelledby": id, "data-name": of.name, title: note },
        el("div", { class: "named" }, el("b", { id }, of.name), of.unit ? el("span", { class: "quiet" }, of.unit) : null, reset),
        el("div", { class: "parts" }, row.body), el("p", { class: "quiet does" }, of.does));
      return { of, row, box, reset };
    });
    element.replaceChildren(...rows.map(({ box }) => box));
    if (!rows.length) element.replaceChildren(el("p", { class: "quiet" }, "This frame has no parameters."));
  }
  let built = null;
  return {
    element,
    // `values`: texts by name that differ from the subject's own.
    show(controls, values) {
      if (built !== controls) build(controls);
      built = controls;
      for (const { of, row, reset } of rows) {
        row.show(values[of.name] ?? of.text);
        reset.hidden = !(of.name in values);
      }
    },
  };
}
