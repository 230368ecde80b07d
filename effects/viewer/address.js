// What is seen, in the address after "#": ID/MACHINE/layer?set.light=1,1,1&upto=3&... What is not said is as in
// FIRST, so short addresses stay short.

const FIRST = {
  view: { id: "", machine: "", size: 0, values: {}, bits: {}, without: [], upto: null },
  other: "", // key of the second machine
  shown: "machine", // of LAYERS
  against: "ideal", // what a wipe or a pair has beside it
  how: "one", // "wipe" or "panes"
  split: 0.5, zoom: 0, centre: null, at: null, labels: true, crop: null,
  gain: 0, // 0: as is usual for the difference
  mode: "signed", // of MODES
  exposure: 0, // stops
};
const PLAIN = ["other", "against", "how", "split", "zoom", "centre", "at", "labels", "gain", "mode", "exposure"];
const BOUNDS = { split: [0, 1], zoom: [0, 64], gain: [0, 128], exposure: [-8, 8] };

const saidAs = (value) =>
  Array.isArray(value) ? value.map((n) => +n.toFixed(1)).join("|") : typeof value === "number" ? String(+value.toFixed(3)) : String(value);

function addressOf(state) {
  const { view } = state, said = new URLSearchParams();
  for (const [name, text] of Object.entries(view.values)) said.set(`set.${name}`, text);
  for (const [part, bits] of Object.entries(view.bits)) said.set(`bits.${part}`, bits);
  if (view.without.length) said.set("without", view.without.join("|"));
  if (view.upto !== null) said.set("upto", view.upto);
  if (view.size) said.set("size", view.size);
  for (const key of PLAIN) {
    if (saidAs(state[key] ?? "") !== saidAs(FIRST[key] ?? "")) said.set(key, saidAs(state[key]));
  }
  const path = [view.id, view.machine, state.shown].map(encodeURIComponent).join("/");
  return `#${path}${said.size ? `?${said}` : ""}`;
}

function readAs(key, text) {
  const like = FIRST[key];
  if (key in BOUNDS) return clamped(Number(text) || 0, ...BOUNDS[key]);
  if (typeof like === "boolean") return text === "true";
  if (like !== null) return text;
  const numbers = text.split("|").map(Number);
  return numbers.length === 2 && numbers.every(Number.isFinite) ? numbers : null;
}

// The state that an address says, or null for one that says none. The viewer refuses what cannot be drawn.
function stateOf(address) {
  const [path, query = ""] = address.replace(/^#/, "").split(/\?(.*)/s);
  if (!path) return null;
  const parts = path.split("/").map((part) => {
    try {
      return decodeURIComponent(part);
    } catch {
      return part;
    }
  });
  const [id, machine = "", shown = ""] = parts;
  const state = { ...FIRST, view: { ...FIRST.view, id, machine, values: {}, bits: {}, without: [] } };
  if (shown in LAYERS) state.shown = shown;
  for (const [key, text] of new URLSearchParams(query)) {
    const [kind, name] = key.split(/\.(.*)/s);
    if (kind === "set" && name) state.view.values[name] = text;
    else if (kind === "bits" && name) state.view.bits[name] = Math.trunc(Number(text)) || 0;
    else if (key === "without") state.view.without = text.split("|");
    else if (key === "upto") state.view.upto = Math.max(0, Math.trunc(Number(text)) || 0);
    else if (key === "size") state.view.size = clamped(Math.trunc(Number(text)) || 0, 0, 2048);
    else if (PLAIN.includes(key)) state[key] = readAs(key, text);
  }
  if (!["one", "wipe", "panes"].includes(state.how)) state.how = "one";
  if (!(state.mode in MODES)) state.mode = "signed";
  if (!(state.against in LAYERS) || state.against === state.shown) state.against = state.shown === "ideal" ? "machine" : "ideal";
  if (state.at) state.at = state.at.map(Math.round);
  return state;
}
