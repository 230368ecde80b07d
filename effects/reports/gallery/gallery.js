// The gallery: grid or figure, by what the address says, and the keys of both.

const KEYS = [
  ["1 2 3", "machine, ideal, reference"], ["4 5", "difference from the ideal, from the reference"],
  ["b, 6", "machine B, and A \u2212 B, where B is chosen"], ["\u2191 \u2193", "the machine before, after, in place"],
  ["Shift 1 2 \u2026, 0", "one panel alone, all in a row"], [", .", "panel before, after"],
  ["w, p, m", "wipe, pair, subtract"], ["a", "the same place of all panels"],
  ["+ \u2212 0", "zoom, fit; from 16:1 pixels show their numbers"], ["Shift + arrows", "move what is seen"],
  ["l", "loupe; then arrows move it, with Shift by 16"], ["v", "read the loupe\u2019s numbers aloud"],
  ["d", "go to the largest difference, from the reference where there is one"], ["[ ]", "gain of a difference"],
  ["c", "difference signed, absolute, in false color"], ["e, E", "lighter, darker"], ["f", "false color"],
  ["x", "crops: one place in all machines"], ["t", "panels\u2019 labels"],
  ["s", "save the picture: the machine\u2019s own pixels"], ["S", "save view: what is shown"],
  ["\u2190 \u2192", "figure before, after, in the grid\u2019s order"], ["Esc", "all figures"], ["/", "search"], ["?", "these keys"],
];

function makeTheme() {
  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const stored = () => {
    try {
      return localStorage.getItem("fixedpipe theme");
    } catch {
      return null; // a browser may keep nothing for files
    }
  };
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const button = el("button", { type: "button", class: "plain theme", onclick() {
    root.dataset.theme = isDark() ? "light" : "dark";
    try {
      localStorage.setItem("fixedpipe theme", root.dataset.theme);
    } catch { /* the switch holds until the page is left */ }
    name();
  } });
  const name = () => {
    button.textContent = isDark() ? "Light" : "Dark";
    button.setAttribute("aria-label", `${button.textContent} colors`);
  };
  if (["light", "dark"].includes(stored())) root.dataset.theme = stored();
  system.addEventListener("change", name);
  name();
  return button;
}

const voice = el("p", { class: "away", role: "status", "aria-live": "polite" });
const announce = (text) => { voice.textContent = text; };
const keys = el("dialog", { "aria-label": "Keys" }, el("h2", {}, "Keys"),
  el("dl", {}, KEYS.flatMap(([key, does]) => [el("dt", {}, key), el("dd", {}, does)])),
  el("form", { method: "dialog" }, el("button", { class: "plain" }, "Close")));

let now = stateOf(location.hash), scrolled = 0;

// The address follows what is shown, without a new entry of the history: only figures are entries. While
// something is dragged it waits: browsers refuse more than a few changes a second.
const ADDRESS_EVERY = 350; // milliseconds
let addressTimer = 0, isAddressLate = false;
function writeAddress() {
  isAddressLate = false;
  history.replaceState(null, "", addressOf(now));
}
function follows() {
  if (addressTimer) {
    isAddressLate = true;
    return;
  }
  writeAddress();
  addressTimer = setTimeout(() => {
    addressTimer = 0;
    if (isAddressLate) follows();
  }, ADDRESS_EVERY);
}
const finishAddress = () => { if (isAddressLate) writeAddress(); };

// Changes what is shown.
function set(changes) {
  now = { ...now, missing: "", ...changes };
  follows();
  show();
}
// Goes to another address, which is an entry of the history.
function go(next) {
  finishAddress();
  location.hash = addressOf(next);
}

const grid = makeGrid(set), figure = makeFigure(set, go, announce);
const main = el("main", { id: "main", tabindex: -1 });
document.body.append(
  el("a", { class: "skip", href: "#main", onclick: (event) => { event.preventDefault(); main.focus(); } }, "Skip to the figures"),
  el("header", { class: "top" },
    el("a", { class: "home", href: "#" }, "fixedpipe"), el("span", { class: "quiet" }, INDEX.says),
    el("button", { type: "button", class: "plain", "aria-keyshortcuts": "?", onclick: () => keys.showModal() }, "Keys"), makeTheme()),
  main, keys, voice,
);

let shown = null;
function show() {
  const page = now.id ? figure : grid;
  document.title = now.id ? `${now.id} ${FIGURES.get(now.id).title}` : "fixedpipe: figures";
  page.update(now);
  if (page.element.parentElement !== main) main.replaceChildren(page.element);
  if (now.id) figure.update(now); // its width is known only in the page
}

function follow() {
  const next = stateOf(location.hash), left = now.id;
  if (!left) scrolled = window.scrollY;
  now = next;
  show();
  if (now.id && now.id !== shown) {
    window.scrollTo(0, 0);
    figure.title.focus({ preventScroll: true });
  } else if (!now.id && left) {
    window.scrollTo(0, scrolled);
    main.querySelector(`[data-id="${CSS.escape(left)}"]`)?.focus({ preventScroll: true });
  }
  shown = now.id;
}

document.addEventListener("keydown", (event) => {
  // In a list the arrows are the list's, letters and digits the page's; in a slider all but its own keys are.
  const isOwn = event.target.closest("select, input[type=range]") && (event.key.length > 1 || event.key === " ");
  const isTyping = isOwn || event.target.closest("input:not([type=range]), textarea, dialog");
  if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
  if (isTyping) {
    if (event.key === "Escape" && event.target.matches("input, select")) event.target.blur();
    return;
  }
  if (event.key === "?") keys.showModal();
  else if (event.key === "/" && !now.id) grid.search.focus();
  else if (!now.id || !figure.key(event)) return;
  event.preventDefault();
});
document.addEventListener("click", finishAddress, true); // a link leaves an entry behind
window.addEventListener("hashchange", follow);
shown = now.id;
show();
