// What the search box finds: words at the beginnings of words, and what readers call the same thing.

// Other names of what the captions say. A word on the left is also found where all words of one of the phrases on
// the right are.
const SYNONYMS = {
  pcf: ["percentage closer"],
  acne: ["shade themselves", "self shadow", "shadow bias"],
  "peter panning": ["shadows float", "bias"],
  lispsm: ["light space perspective"],
  embm: ["offset bump", "environment bump"],
  irradiance: ["diffuse environment", "environment diffuse", "diffuse map", "diffuse light"],
  glossy: ["phong", "filtered environment", "prefiltered", "frosted"],
  overflow: ["clamp"],
  saturation: ["clamp"],
  banding: ["bands", "rings", "steps"],
  quantization: ["rounded", "bands", "rings", "bits"],
  precision: ["bits"],
  moire: ["aliasing"],
  antialiasing: ["aliasing", "filtered"],
  brdf: ["reflectance"],
  "cook torrance": ["torrance sparrow"],
  "volume rendering": ["slices", "volume"],
  raytracing: ["rays"],
  mipmap: ["mip map", "levels"],
  nvparse: ["register combiners"],
  dot3: ["dot products", "dot product"],
  csm: ["frustum slices", "slices"],
  cascades: ["frustum slices", "slices"],
  gi: ["radiosity"],
  ao: ["visibility"],
  cubemap: ["cube map"],
  spheremap: ["sphere map"],
  gf256: ["geforce 256"],
  gf3: ["geforce 3"],
  xbox: ["nv2a"],
  ir: ["infinitereality"],
};
// Spellings that are one word.
const SPELLINGS = [[/colour/g, "color"], [/grey/g, "gray"], [/metre/g, "meter"], [/centre/g, "center"], [/isation/g, "ization"], [/ising\b/g, "izing"], [/\u00e9/g, "e"]];

const spelled = (text) => SPELLINGS.reduce((found, [from, to]) => found.replace(from, to), text.toLowerCase());
// Words of a text, each also without its hyphens and underscores: "mip-map" is mip, map and mipmap.
function searched(texts) {
  const words = spelled(texts.join(" ")).split(/[^\p{L}\p{N}_.-]+/u).flatMap((word) => {
    const parts = word.split(/[-_.]+/).filter(Boolean);
    return parts.length > 1 ? [parts.join(""), ...parts] : parts;
  });
  return ` ${words.join(" ")} `;
}
// "figure 4" of F004-4, as it is called in its paper; nothing of a technique's demonstration.
function figureNumber(id) {
  const number = /^[FT]\d+-(\d+)/.exec(id)?.[1];
  return number ? `${id[0] === "T" ? "table" : "figure"}number${number}` : "";
}

const joined = (word) => word.replace(/[-_.]+/g, "");
// Whether a text of `searched` is asked for by the words of a search.
function sought(query) {
  let rest = ` ${spelled(query).trim()} `;
  const asked = [];
  // "figure 4" is that number, and not whatever has a 4.
  rest = rest.replace(/\s(fig(?:ure)?|table)\.?\s+(\d+)(?=\s)/g, (_, what, number) => {
    asked.push([[`${what === "table" ? "table" : "figure"}number${number} `]]);
    return " ";
  });
  rest = rest.replace(/\sf(\d)-(\d+)(?=\s)/g, (_, paper, number) => ` f00${paper}-${number} `); // F4-4 is F004-4
  for (const [name, phrases] of Object.entries(SYNONYMS)) {
    if (!name.includes(" ") || !rest.includes(` ${name}`)) continue;
    asked.push([[...name.split(" ")], ...phrases.map((phrase) => phrase.split(" "))]);
    rest = rest.replace(` ${name}`, " ");
  }
  const words = rest.split(/[\s,;:()"]+/).map((word) => joined(word.replace(/^[^\p{L}\p{N}]+|[^\p{L}\p{N}]+$/gu, ""))).filter(Boolean);
  for (const word of words) {
    const names = Object.keys(SYNONYMS).filter((name) => word.length > 2 ? joined(name).startsWith(word) && name.length - word.length < 3 : name === word);
    asked.push([[word], ...names.flatMap((name) => SYNONYMS[name].map((phrase) => phrase.split(" ")))]);
  }
  return (text) => asked.every((ways) => ways.some((way) => way.every((word) => text.includes(` ${word}`))));
}
