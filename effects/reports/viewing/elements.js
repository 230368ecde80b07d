// What all parts of a page are made with.

// An element with its attributes and children. Text only ever becomes text nodes, so it needs no escaping.
function el(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) {
      made.setAttribute(key, value === true ? "" : value);
    }
  }
  made.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
  return made;
}

function newCanvas(width, height) {
  const canvas = el("canvas", { width, height });
  return { canvas, context: canvas.getContext("2d", { willReadFrequently: true }) };
}

// The last few answers of a slow function, by its argument.
function kept(make, most) {
  const answers = new Map();
  return (key) => {
    const answer = answers.get(key) || make(key);
    answers.delete(key);
    answers.set(key, answer);
    answer.catch(() => answers.delete(key));
    if (answers.size > most) answers.delete(answers.keys().next().value);
    return answer;
  };
}

const fourDigits = (number) => {
  if (typeof number !== "number") return String(number);
  return Number.isInteger(number) ? String(number) : String(+number.toPrecision(4));
};

const clamped = (value, low, high) => Math.min(high, Math.max(low, value));

// Offers bytes as a file to be kept.
function offer(blob, name) {
  const address = URL.createObjectURL(blob);
  el("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60000); // some browsers read it only now
}
