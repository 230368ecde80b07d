// What is shown, in the address after "#": ID/MACHINE/view?zoom=8&..., or ?q=...&machine=... of the grid.
// What is not said is as in DEFAULTS, so short addresses stay short.

const DEFAULTS = {
  id: "", machine: "", view: "machine", // a figure; no id: the grid
  missing: "", // the figure that the address asked for and this gallery has not
  other: "", // the machine that is B of A and B
  panel: 0, // the panel that is shown alone, from 1; 0: all in a row
  how: "one", // one picture, or of HOW
  against: "", // the view that is beside it, or subtracted
  beside: 0, // and its panel; 0: the same
  split: 0.5, // where a wipe divides, of the stage's width
  zoom: 0, // 0: fit
  centre: null, // of what is seen, in the picture's pixels
  at: null, // the loupe's pixel where it is pinned
  gain: 0, // 0: the record's own
  mode: "signed",
  exposure: 0, // powers of two by which pictures are lighter
  tone: "", // "false": luminance in false color
  crop: null, // of the strip: the left top corner and the edge, in the picture's pixels
  labels: true,
  q: "", paper: "", machines: [], methods: [], techniques: [], differ: false, failed: false, // of the grid
};
const OF_GRID = ["q", "paper", "machines", "methods", "techniques", "differ", "failed"];
const OF_FIGURE = [
  "other", "panel", "how", "against", "beside", "split", "zoom", "centre", "at", "gain", "mode", "exposure", "tone", "crop", "labels",
];

// An address is anybody's: numbers from where to where.
const BOUNDS = { split: [0, 1], zoom: [0, 64], gain: [0, 128], exposure: [0, 6], panel: [0, 99], beside: [0, 99] };
const NUMBERS = { centre: 2, at: 2, crop: 3 }; // how many each has

function written(value) {
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (Array.isArray(value)) return value.join("|");
  return typeof value === "number" ? String(+value.toFixed(3)) : value;
}

const readNumber = (key, text) => clamped(Number(text) || 0, ...BOUNDS[key]);

function readAs(key, text) {
  const like = DEFAULTS[key];
  if (["panel", "beside", "exposure"].includes(key)) return Math.trunc(readNumber(key, text));
  if (key in BOUNDS) return readNumber(key, text);
  if (key === "how") return text in HOW ? text : like;
  if (typeof like === "boolean") return text === "yes";
  if (Array.isArray(like)) return text ? text.split("|") : [];
  if (like !== null) return text;
  const numbers = text.split("|").map(Number);
  return numbers.length === NUMBERS[key] && numbers.every(Number.isFinite) ? numbers : null;
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
  const [asked = "", ...rest] = path ? path.split("/").map(decoded) : [];
  const id = FIGURES.has(asked) ? asked : [...FIGURES.keys()].find((one) => one.toLowerCase() === asked.toLowerCase()) || asked;
  // ID/view is the view on the figure's first machine, as addresses are written where none was chosen.
  const machine = (rest.find((part) => !(part in VIEWS)) || "").toUpperCase(), view = rest.find((part) => part in VIEWS) || DEFAULTS.view;
  const state = { ...DEFAULTS, ...(FIGURES.has(id) ? { id, machine, view } : { missing: id }) };
  for (const [key, text] of new URLSearchParams(query)) {
    if ([...OF_GRID, ...OF_FIGURE].includes(key)) state[key] = readAs(key, text);
  }
  // A pixel that an address names is seen, also where it does not say what is in the middle.
  if (state.zoom && !state.centre) state.centre = state.at;
  return state;
}

function isMatch(figure, state, isSought) {
  const any = (chosen, has) => !chosen.length || chosen.some((one) => has.includes(one));
  return (
    isSought(figure.text) &&
    (!state.paper || figure.paper === state.paper) &&
    any(state.machines, figure.machines) &&
    any(state.methods, figure.methods) &&
    any(state.techniques, figure.techniques) &&
    (!state.differ || figure.machines_differ) &&
    (!state.failed || figure.failed > 0 || figure.failures.length > 0)
  );
}

for (const figure of FIGURES.values()) {
  const paper = INDEX.papers[figure.paper];
  figure.text = searched([
    figure.id, figureNumber(figure.figure || figure.id), figure.title, figure.caption, ...figure.must_see, ...figure.labels,
    paper.authors, paper.title, figure.paper, ...figure.methods, ...figure.techniques.flatMap((id) => [id, techniqueName(id)]),
    ...figure.machines.flatMap((key) => [key, machineName(key)]),
  ]);
}
// The figures that are in the grid, in its order: by paper.
const PAPERS_IN_ORDER = [...new Set(INDEX.figures.map((figure) => figure.paper))];
const IN_ORDER = PAPERS_IN_ORDER.flatMap((key) => INDEX.figures.filter((figure) => figure.paper === key));
function matches(state) {
  const isSought = sought(state.q);
  return IN_ORDER.filter((figure) => isMatch(figure, state, isSought));
}
