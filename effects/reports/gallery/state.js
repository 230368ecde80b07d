// What is shown, in the address after "#": ID/MACHINE/view?zoom=8&..., or ?q=...&machine=... of the grid.
// What is not said is as in DEFAULTS, so short addresses stay short.

const DEFAULTS = {
  id: "", machine: "", view: "machine", // a figure; no id: the grid
  missing: "", // the figure that the address asked for and this gallery has not
  other: "", // the machine that is B of A and B
  how: "one", // one picture, "wipe" or "pair"
  against: "", // the view that a wipe or a pair has beside it
  split: 0.5, // where a wipe divides, of the stage's width
  zoom: 0, // 0: fit
  centre: null, // of what is seen, in the picture's pixels
  at: null, // the loupe's pixel where it is pinned
  gain: 0, // 0: the record's own
  mode: "signed",
  labels: true,
  q: "", paper: "", machines: [], methods: [], differ: false, failed: false, // of the grid
};
const OF_GRID = ["q", "paper", "machines", "methods", "differ", "failed"];
const OF_FIGURE = ["other", "how", "against", "split", "zoom", "centre", "at", "gain", "mode", "labels"];

// An address is anybody's: numbers from where to where.
const BOUNDS = { split: [0, 1], zoom: [0, 16], gain: [0, 128] };

function written(value) {
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (Array.isArray(value)) return value.join("|");
  return typeof value === "number" ? String(+value.toFixed(3)) : value;
}

function readAs(key, text) {
  const like = DEFAULTS[key];
  if (key in BOUNDS) return Math.min(BOUNDS[key][1], Math.max(BOUNDS[key][0], Number(text) || 0));
  if (key === "how") return ["wipe", "pair"].includes(text) ? text : like;
  if (typeof like === "boolean") return text === "yes";
  if (Array.isArray(like)) return text ? text.split("|") : [];
  if (like !== null) return text;
  const numbers = text.split("|").map(Number);
  return numbers.length === 2 && numbers.every(Number.isFinite) ? numbers : null;
}

function addressOf(state) {
  const path = state.id ? [state.id, state.machine, state.view].filter(Boolean) : [];
  const said = (state.id ? [...OF_FIGURE, ...OF_GRID] : OF_GRID)
    .filter((key) => written(state[key] ?? "") !== written(DEFAULTS[key] ?? ""))
    .map((key) => `${key}=${encodeURIComponent(written(state[key]))}`);
  return `#${path.map(encodeURIComponent).join("/")}${said.length ? `?${said.join("&")}` : ""}`;
}

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

function stateOf(address) {
  const [path, query = ""] = address.replace(/^#/, "").split(/\?(.*)/s);
  const [id = "", ...rest] = path ? path.split("/").map(decoded) : [];
  // ID/view is the view on the figure's first machine, as addresses are written where none was chosen.
  const machine = rest.find((part) => !(part in VIEWS)) || "", view = rest.find((part) => part in VIEWS) || DEFAULTS.view;
  const state = { ...DEFAULTS, ...(FIGURES.has(id) ? { id, machine, view } : { missing: id }) };
  for (const [key, text] of new URLSearchParams(query)) {
    if ([...OF_GRID, ...OF_FIGURE].includes(key)) state[key] = readAs(key, text);
  }
  // A pixel that an address names is seen, also where it does not say what is in the middle.
  if (state.zoom && !state.centre) state.centre = state.at;
  return state;
}

function isMatch(figure, state) {
  const any = (chosen, has) => !chosen.length || chosen.some((one) => has.includes(one));
  const words = state.q.toLowerCase().split(/\s+/).filter(Boolean);
  return (
    words.every((word) => figure.text.includes(word)) &&
    (!state.paper || figure.paper === state.paper) &&
    any(state.machines, figure.machines) &&
    any(state.methods, figure.methods) &&
    (!state.differ || figure.machines_differ) &&
    (!state.failed || figure.failed > 0 || figure.failures.length > 0)
  );
}

for (const figure of FIGURES.values()) {
  const paper = INDEX.papers[figure.paper];
  figure.text = [
    figure.id, figure.title, figure.caption, paper.authors, paper.title, figure.paper,
    ...figure.techniques, ...figure.methods, ...figure.machines.flatMap((key) => [key, nameOf(key)]),
  ].join(" ").toLowerCase();
}
const matches = (state) => [...FIGURES.values()].filter((figure) => isMatch(figure, state));
