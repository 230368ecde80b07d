// A window: state, requests, pictures that come, undo. `fixedpipeView` builds it into an element.

const ADDRESS_EVERY = 350; // milliseconds: browsers refuse more changes of an address
const MOST_UNDONE = 200, MOST_TIMES = 500;

function makeWindow(root, link, options) {
  let state = { ...FIRST, view: { ...FIRST.view } }, names = {}, subjects = [], tool = "look";
  let serial = 0, asked = "", aboutOf = "", frame = 0, isAsking = false, isLinked = false;
  let lensOn = false, hovered = null, wantedHistory = 0;
  const waiting = new Map(); // number of a question -> what it is of
  const begun = new Map(); // serial -> when the gesture was made
  const times = [], undone = { back: [], on: [], now: "" };
  const model = makeModel();

  const voice = el("p", { class: "away", role: "status", "aria-live": "polite" });
  const announce = (text) => { voice.textContent = text; };
  const failure = el("p", { class: "failed", role: "alert", hidden: true });
  const connection = el("p", { class: "failed", role: "alert", hidden: true });
  const loupe = makeLoupe(announce), stage = makeStage(set, pointed);
  const controls = makeControls((name, text, isDone) => setValues({ [name]: text }, isDone));
  const passes = makePasses((upto, isDone) => setView({ upto }, isDone));
  const precision = makePrecision(({ bits, clamp }) => {
    if (bits) setView({ bits: Object.fromEntries(Object.entries({ ...state.view.bits, [bits[0]]: bits[1] }).filter(([, n]) => n)) }, true);
    else setView({ without: clamp[1] ? state.view.without.filter((name) => name !== clamp[0]) : [...state.view.without, clamp[0]].sort() }, true);
  });
  const panels = makePanels((kind) => {
    panels.measuring();
    question(kind, { view: state.view });
  });
  const bars = makeBars({
    machine: (key) => setView({ machine: key, bits: {}, without: [], upto: null }, true),
    other: (key) => change({ other: key, ...(key ? { against: "other", how: state.how === "one" ? "wipe" : state.how, ...(isOfOther(state.shown) ? { shown: "machine" } : {}) } : withoutOther()) }, true),
    against: (name) => set({ against: name }), shown: chooseLayer, compare, gain: (gain) => set({ gain }), mode: (mode) => set({ mode }),
    exposure: (exposure) => set({ exposure }), tool: (name) => { tool = name; show(); },
    zoomBy: (by) => stage.zoomBy(by), zoom: (zoom) => set({ zoom, centre: zoom ? state.centre : null }),
    lens: toggleLens, say: () => loupe.say(), keep, undo: () => unmake("back", "on"), redo: () => unmake("on", "back"),
    size: (size) => setView({ size: size === model.about.size ? 0 : size }, true),
  });

  const subject = choice("Figure", (id) => setView({ ...FIRST.view, id, machine: "" }, true));
  const title = el("h1", { tabindex: -1 }), status = el("p", { class: "status", id: "status" });
  const speed = el("span", { class: "speed" }), told = el("span", {}), proof = el("span", { class: "proof" });
  const caption = el("p", { class: "caption" }), mustSee = el("p", { class: "quiet" }), spoken = el("code", {});
  const sizes = el("p", { class: "quiet" });
  status.append(told, proof, speed);
  const copy = el("button", { type: "button", class: "plain copy", onclick: () => navigator.clipboard?.writeText(spoken.textContent) }, "copy");
  const commandBox = el("div", { class: "copyable" }, spoken, copy);
  const keys = el("dialog", { "aria-label": "Keys" }, el("h2", {}, "Keys"),
    el("dl", {}, KEYS.flatMap(([key, does]) => [el("dt", {}, key), el("dd", {}, does)])),
    el("form", { method: "dialog" }, el("button", { class: "plain" }, "Close")));
  const section = (name, body, isOpen) => {
    const made = el("details", { open: isOpen, "data-panel": name }, el("summary", {}, el("h2", {}, name)), body);
    return made;
  };
  const pixel = section("Pixel", panels.history, false);
  const element = el("div", { class: "viewer" },
    el("header", { class: "top" }, el("b", { class: "home" }, "fixedpipe view"), el("label", {}, el("span", { class: "away" }, "Figure"), subject),
      el("button", { type: "button", class: "plain", "aria-keyshortcuts": "?", onclick: () => keys.showModal() }, "Keys"),
      makeTheme(options.isPage ? document.documentElement : root.host || root)),
    el("main", { class: "live" },
      el("div", { class: "seen" }, title, bars.above, connection, failure,
        el("div", { class: "frame" }, stage.element, loupe.element), bars.under, status,
        section("Passes", passes.element, true), bars.keep, caption, mustSee, commandBox, sizes),
      el("aside", { "aria-label": "Parameters and pixel" },
        pixel, section("Parameters", controls.element, true), section("Bits and clamps", precision.element, false), section("Registers", panels.registers, false))),
    keys, voice);

  const gestures = makeGestures(stage, () => ({ tool: currentTool(), begin: valuesNow(), high: panelHeight() }),
    (drag, right, down, isDone, event) => setValues(afterTurn(model.about.controls, drag.tool, drag.begin, right, down), isDone, event),
    (at, event) => pointed(at, event, true));

  function currentTool() {
    return model.about && toolsOf(model.about.controls).includes(tool) ? tool : "look";
  }
  const valuesNow = () => Object.fromEntries((model.about?.controls || []).map((of) => [of.name, state.view.values[of.name] ?? of.text]));
  const panelHeight = () => Math.max(80, stage.element.clientHeight * (state.how === "panes" ? 0.5 : 1));

  // ------------------------------------------------------------------------------------------ state

  // What is shown, without a new picture of the machine.
  function set(changes) {
    state = { ...state, ...changes };
    follows();
    show();
  }
  // What is drawn. `isDone`: it is a step of undo.
  function change(changes, isDone, event) {
    if ((changes.other ?? state.other) !== state.other) model.forget("other"); // a picture of another machine
    state = { ...state, ...changes };
    if (isDone) remember();
    request(event);
    set({});
  }
  function setView(changes, isDone, event) {
    change({ view: { ...state.view, ...changes } }, isDone, event || { timeStamp: performance.now() });
  }
  function setValues(found, isDone, event) {
    const own = Object.fromEntries((model.about?.controls || []).map((of) => [of.name, of.text]));
    const values = Object.fromEntries(Object.entries({ ...state.view.values, ...found }).filter(([name, text]) => text !== null && text !== own[name]));
    setView({ values }, isDone, event);
  }
  const drawn = () => JSON.stringify({ view: state.view, other: state.other });
  function remember() {
    const now = drawn();
    if (now === undone.now) return;
    if (undone.now) undone.back.push(undone.now);
    if (undone.back.length > MOST_UNDONE) undone.back.shift();
    undone.on = [];
    undone.now = now;
  }
  function unmake(from, to) {
    remember();
    const found = undone[from].pop();
    if (!found) return;
    undone[to].push(undone.now);
    undone.now = found;
    change(JSON.parse(found), false);
    announce(from === "back" ? "undone" : "done again");
  }
  const isOfOther = (name) => (LAYERS[name].from || name) === "other";
  const withoutOther = () => ({ other: "", ...(isOfOther(state.shown) ? { shown: "machine" } : {}), ...(isOfOther(state.against) ? { against: "ideal", how: "one" } : {}) });

  let addressTimer = 0;
  function follows() {
    options.changed?.(state);
    if (!options.isPage || addressTimer || !state.view.id) return;
    addressTimer = setTimeout(() => {
      addressTimer = 0;
      history.replaceState(null, "", addressOf(state));
    }, ADDRESS_EVERY);
  }

  // ---------------------------------------------------------------------------------- asking, hearing

  const layersSeen = () => [state.shown, ...(state.how === "one" ? [] : [state.against])].map((name) => LAYERS[name].from || name);
  function request(event) {
    if (!isLinked || !state.view.id) return;
    if (event && !begun.has(serial + 1)) begun.set(serial + 1, event.timeStamp || performance.now());
    isAsking = true;
    if (!frame) frame = requestAnimationFrame(send);
    setTimeout(send, 60); // a page that is not seen has no frames
  }
  function send() {
    if (frame) cancelAnimationFrame(frame);
    [frame, isAsking] = [0, false];
    const wants = ["ideal", ...(layersSeen().includes("reference") ? ["reference"] : [])];
    const message = { view: state.view, other: state.other, wants }, key = JSON.stringify(message);
    element.dataset.asked = String(serial);
    if (key === asked || !isLinked) return;
    asked = key;
    link.send({ do: "draw", number: ++serial, ...message });
    element.dataset.asked = String(serial);
    if (begun.size > 60) begun.delete(begun.keys().next().value);
    const about = JSON.stringify([state.view.id, state.view.machine]);
    if (about !== aboutOf || !state.view.machine) {
      aboutOf = about;
      question("about", { view: state.view });
    } else spokenLater();
  }
  let spokenTimer = 0;
  function spokenLater() {
    clearTimeout(spokenTimer);
    spokenTimer = setTimeout(() => question("about", { view: state.view }), 400);
  }
  let questions = 1e6;
  function question(kind, message) {
    waiting.set(++questions, kind);
    if (waiting.size > 50) waiting.delete(waiting.keys().next().value);
    link.send({ do: kind, number: questions, ...message });
    return questions;
  }

  const HEARD = {
    hello({ start, subjects: listed, machines }) {
      [names, subjects] = [machines, listed];
      if (!state.view.id) {
        const wanted = (options.isPage && stateOf(location.hash)) || options.first?.() || null;
        state = wanted || { ...FIRST, view: { ...FIRST.view, ...start } };
        if (!state.view.machine && state.view.id === start.id) state.view.machine = start.machine;
      }
      asked = aboutOf = "";
      undone.now ||= drawn();
      model.forget("machine", "ideal", "reference", "other");
      request();
    },
    answer({ number, value }) {
      const kind = waiting.get(number);
      waiting.delete(number);
      if (kind === "about" && value.id === state.view.id) heardAbout(value);
      else if (kind === "history" && number === wantedHistory) panels.showHistory(value);
      else if (kind === "registers") panels.showRegisters(value);
    },
    refused({ number, words }) {
      const kind = waiting.get(number);
      waiting.delete(number);
      if (kind === "history") panels.refusedHistory(words);
      else if (kind === "registers") panels.refusedRegisters(words);
      else fail(words);
    },
    failed({ number, words }) {
      if (number === serial) fail(words);
    },
    numbers({ number, value }) {
      if (number !== serial) return;
      model.setNumbers(value);
      known = { number, value };
      prove();
      show();
    },
  };
  function heardAbout(value) {
    const isNew = model.about?.id !== value.id || model.about?.machine !== value.machine;
    spoken.textContent = value.spoken ? `fixedpipe figures ${value.spoken}` : "";
    if (isNew || !model.about) {
      model.setAbout(value);
      const can = toolsOf(value.controls);
      if (!can.includes(tool) || tool === "look") tool = usualTool(value.controls);
    }
    show();
  }
  function fail(words) {
    failure.textContent = words;
    failure.hidden = !words;
    stage.element.setAttribute("aria-busy", "false");
  }
  // Digests may come before the picture that they are of, which waits until earlier ones are shown.
  let known = null;
  async function prove() {
    const of = model.pictures.machine;
    if (!of || !known?.value.shown || known.number !== serial || of.serial !== serial || element.dataset.proved === String(serial)) return;
    const { shown, sha256 } = known.value;
    const found = await digestOf(of);
    if (of.serial !== serial) return;
    element.dataset.sha256 = sha256;
    element.dataset.canvas = found || "none";
    element.dataset.proved = String(of.serial);
    proof.dataset.equal = String(found === shown);
    proof.textContent = found === null ? `sha256 of the machine\u2019s picture ${sha256.slice(0, 12)}\u2026 ` :
      found === shown ? `the canvas holds the machine\u2019s bytes, sha256 ${sha256.slice(0, 12)}\u2026 ` : "the canvas holds other bytes than the machine drew! ";
    proof.title = sha256;
  }

  link.open({
    linked(is, reason) {
      isLinked = is;
      connection.hidden = is;
      connection.textContent = is ? "" : reason || "The viewer has ended, or cannot be reached. Start it again in its terminal; this window waits, and keeps what it shows.";
      if (is) asked = "";
    },
    said: (message) => HEARD[message.say]?.(message),
    picture(header, bytes, size) {
      const isTaken = model.take(header, bytes);
      link.send({ do: "shown", number: header.number, lost: !isTaken });
      counted.bytes += size;
      counted.pictures++;
      if (header.serial === serial && header.name === "machine") fail("");
      if (header.name === "machine") {
        arrived(header);
        prove();
      }
      else if (isTaken) show();
    },
    kept: (name, bytes, number) => {
      const kind = waiting.get(number);
      waiting.delete(number);
      element.dataset.kept = name;
      offer(new Blob([bytes], { type: kind === "picture" ? "image/png" : "application/octet-stream" }), name);
      announce(`${name} is saved.`);
    },
  });

  // A picture of the machine: painted at the next frame of the screen; then its time is known.
  const counted = { bytes: 0, pictures: 0 };
  let isPainting = false;
  function arrived(header) {
    if (state.how === "one" && state.shown !== "machine" && model.isOld("ideal")) model.setNumbers({});
    if (isPainting) return;
    isPainting = true;
    const paint = () => {
      if (!isPainting) return;
      isPainting = false;
      show();
      const of = model.pictures.machine, since = begun.get(of.serial);
      if (since !== undefined) times.push({ serial: of.serial, at: performance.now(), latency: performance.now() - since, bytes: header.box[2] * header.box[3] * 4, ...of.header.milliseconds });
      if (times.length > MOST_TIMES) times.shift();
      for (const number of begun.keys()) if (number <= of.serial) begun.delete(number);
      measured();
    };
    requestAnimationFrame(paint);
    setTimeout(paint, 60);
  }
  function measured() {
    const last = times.slice(-12), span = last.length > 1 ? last[last.length - 1].at - last[0].at : 0;
    const rate = span && performance.now() - last[0].at < 4000 ? (1000 * (last.length - 1)) / span : 0;
    const latest = times[times.length - 1];
    speed.textContent = latest ? `${rate >= 1 ? `${rate.toFixed(0)} pictures a second, ` : ""}${latest.latency.toFixed(0)} ms from hand to picture` : "";
    sizes.textContent = `${counted.pictures} pictures, ${(counted.bytes / 1e6).toFixed(1)} MB came to this window.`;
  }

  // --------------------------------------------------------------------------------------------- acts

  function chooseLayer(name) {
    if (isOfOther(name) && !state.other) return;
    set({ shown: name, ...(state.against === name ? { against: state.shown } : {}) });
    request();
  }
  function compare(how) {
    if (state.how === how) return set({ how: "one" });
    const against = state.against === state.shown ? (state.shown === "ideal" ? "machine" : "ideal") : state.against;
    set({ how, against });
    request();
    return undefined;
  }
  function toggleLens() {
    lensOn = !lensOn;
    hovered = null;
    if (lensOn && !state.at && model.pictures.machine) set({ at: stage.within(state.centre || [model.pictures.machine.width / 2, model.pictures.machine.height / 2]) });
    else show();
  }
  function pointed(at, event, isClick) {
    if (isClick) {
      if (at) mark(at);
      return;
    }
    hovered = at && { at, event };
    if (lensOn) showLoupe();
  }
  function mark(at) {
    set({ at });
    pixel.open = true;
    panels.waits(at);
    wantedHistory = question("history", { view: state.view, at });
  }
  function showLoupe() {
    const where = hovered || (state.at && { at: state.at });
    const isSeen = lensOn && where && model.pictures.machine && where.at[0] < model.pictures.machine.width && where.at[1] < model.pictures.machine.height;
    loupe.show(isSeen ? model.seenAt(where.at, state) : null, where?.at, hovered?.event);
  }
  function keep(kind) {
    if (kind === "link") {
      navigator.clipboard?.writeText(options.isPage ? new URL(addressOf(state), location.href).href : addressOf(state));
      announce("The address is copied. It opens this viewer only.");
    } else question(kind, { view: state.view });
  }

  function show() {
    const layers = [{ view: state.shown, panel: 0 }, ...(state.how === "one" ? [] : [{ view: state.against, panel: 0 }])];
    const shownState = { ...state, layers, at: inside(state.at) };
    const isAsBuilt = !Object.keys(state.view.bits).length && !state.view.without.length;
    model.setNames({ machine: isAsBuilt ? "" : `${names[state.view.machine] || "machine"}, changed`,
      other: `${names[state.other] || ""}${state.other === state.view.machine && !isAsBuilt ? ", as built" : ""}` });
    stage.show(model.stage(shownState), shownState);
    stage.element.classList.toggle("turns", currentTool() !== "look");
    const { about } = model, header = model.pictures.machine?.header;
    bars.show({ state, model, tool: currentTool(), isLens: lensOn, canUndo: undone.back.length > 0, canRedo: undone.on.length > 0, names,
      scale: model.pictures.machine ? stage.scaleInWords() : "" });
    fill(subject, subjects.map((id) => [id, id]), state.view.id);
    subject.hidden = subjects.length < 2;
    passes.show(state.view.upto, header);
    if (about) {
      title.replaceChildren(el("span", {}, about.id), ` ${about.title}`);
      if (options.isPage) document.title = `${about.id}: ${about.title}`;
      caption.textContent = about.caption;
      mustSee.textContent = about.must_see;
      controls.show(about.controls, state.view.values);
      precision.show(about, state.view);
    }
    commandBox.hidden = !spoken.textContent || Boolean(Object.keys(state.view.bits).length || state.view.without.length || state.view.upto !== null);
    element.dataset.serial = String(model.pictures.machine?.serial ?? -1);
    element.dataset.asked = String(serial + isAsking);
    element.dataset.ideal = String(model.has("ideal") && !model.isOld("ideal"));
    const { difference, no_ideal: none } = model.numbers;
    const words = difference && !model.isOld("ideal") ? `, ${difference.identical ? "equal to the ideal\u2019s codes" : `${difference.pixels} pixels differ from the ideal, RMS ${fourDigits(255 * difference.rms)} of 255`}` : none ? `. ${none}` : "";
    told.textContent = header ? `${names[state.view.machine] || ""}${isAsBuilt ? "" : ", changed"}, ${header.width} \u00d7 ${header.height} pixels, ${header.bits} bits${words}. ` : "";
    if (model.pictures.machine?.serial !== serial) proof.textContent = "";
    if (state.exposure) told.textContent += `Shown \u00d7 ${fourDigits(2 ** state.exposure)}; codes are as drawn. `;
    showLoupe();
  }
  const inside = (at) => (at && model.pictures.machine && at[0] >= 0 && at[1] >= 0 && at[0] < model.pictures.machine.width && at[1] < model.pictures.machine.height ? at : null);

  // --------------------------------------------------------------------------------------------- keys

  function movePoint([dx, dy], by) {
    const at = stage.within([state.at[0] + dx * by, state.at[1] + dy * by]);
    set({ at, ...(state.zoom ? { centre: at } : {}) });
    loupe.say();
  }
  function key(event) {
    const layer = Object.keys(LAYERS).find((name) => LAYERS[name].key === event.key);
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (layer && model.available().includes(layer)) chooseLayer(layer);
    else if (arrows && state.at && (lensOn || currentTool() === "look" || event.shiftKey)) movePoint(arrows, event.shiftKey ? 16 : 1);
    else if (arrows && stage.element === element.getRootNode().activeElement) return gestures.key(event);
    else {
      const turnBy = Object.keys(TOOLS).find((name) => TOOLS[name].key === event.key);
      if (turnBy) {
        tool = turnBy;
        show();
        return true;
      }
      const gainBy = (by) => set({ gain: clamped((state.gain || 1) * by, 1, 128) });
      const action = {
        "+": () => stage.zoomBy(1), "=": () => stage.zoomBy(1), "-": () => stage.zoomBy(-1), 0: () => set({ zoom: 0, centre: null }),
        w: () => compare("wipe"), p: () => compare("panes"), l: toggleLens, v: () => loupe.say(),
        ",": () => passes.step(-1), ".": () => passes.step(1), "[": () => gainBy(0.5), "]": () => gainBy(2),
        c: () => set({ mode: Object.keys(MODES)[(Object.keys(MODES).indexOf(state.mode) + 1) % 3] }),
        e: () => set({ exposure: clamped(state.exposure + 0.5, -4, 4) }), E: () => set({ exposure: clamped(state.exposure - 0.5, -4, 4) }),
        z: () => unmake("back", "on"), y: () => unmake("on", "back"), s: () => keep("script"), "?": () => keys.showModal(),
        Escape: () => { lensOn = false; set({ at: null }); }, Enter: () => state.at && mark(state.at),
      }[event.key];
      if (!action || (event.key === "Enter" && stage.element !== element.getRootNode().activeElement)) return false;
      action();
    }
    return true;
  }
  function onkey(event) {
    const target = event.composedPath()[0];
    const isTyping = target.closest?.("input:not([type=checkbox]), select, textarea, dialog, summary");
    const isText = target.closest?.("input[type=text], input[type=number], textarea"); // which undo by themselves
    const isUndo = (event.ctrlKey || event.metaKey) && ["z", "y"].includes(event.key.toLowerCase()) && !isText;
    if (event.defaultPrevented || (isTyping && !isUndo) || event.altKey || ((event.ctrlKey || event.metaKey) && !isUndo)) return;
    if (isUndo) unmake(...(event.key.toLowerCase() === "y" || event.shiftKey ? ["on", "back"] : ["back", "on"]));
    else if (!key(event)) return;
    event.preventDefault();
  }
  const listens = options.isPage ? document : element;
  listens.addEventListener("keydown", onkey);
  if (options.isPage) {
    window.addEventListener("hashchange", () => {
      const next = stateOf(location.hash);
      if (next && addressOf(next) !== addressOf(state)) change(next, true);
    });
  }
  root.append(element);
  element.fixedpipe = {
    times, counted, get state() { return state; }, get serial() { return serial; },
    set(next) { change(next, true); },
  };
  show();
  return () => {
    listens.removeEventListener("keydown", onkey);
    link.close();
    element.remove();
  };
}

globalThis.connectSocket = connectSocket;
globalThis.connectModel = connectModel;
globalThis.fixedpipeView = makeWindow;
