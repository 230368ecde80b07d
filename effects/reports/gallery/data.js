// What the page holds, and what it fetches. A page that was opened from a file may read no other file, but it
// may run scripts: records/ID.js calls record(...), pictures/DIGEST.js calls picture(...).

const INDEX = JSON.parse(document.getElementById("index").textContent);
const FIGURES = new Map(INDEX.figures.map((figure) => [figure.id, figure]));

const techniqueName = (id) => INDEX.techniques[id]?.name || "";
const machineName = (machine) => INDEX.machines[machine] || machine;

const arrivals = new Map(); // a script's address -> what to call with what it delivers

function fetched(address, charset) {
  return new Promise((resolve, reject) => {
    arrivals.set(address, resolve);
    const script = el("script", { src: address.split("/").map(encodeURIComponent).join("/"), charset });
    script.onload = script.onerror = () => {
      script.remove();
      arrivals.delete(address);
      reject(new Error(`${address} cannot be read. Draw the figure again.`));
    };
    document.head.append(script);
  });
}

window.record = (record) => arrivals.get(`records/${record.id}.js`)?.(record);
window.picture = (digest, width, height, text, base) =>
  arrivals.get(`pictures/${digest}.js`)?.({ width, height, text, base });

const recordOf = kept((id) => fetched(`records/${id}.js`, "utf-8"), 40);

// A picture's script is read as windows-1252, in which each byte is one character.
const BYTES = new Map(
  [...new TextDecoder("windows-1252").decode(Uint8Array.from({ length: 256 }, (_, byte) => byte))].map(
    (character, byte) => [character.charCodeAt(0), byte],
  ),
);

// {width, height, canvas, data: RGBA bytes, top row first}
const bytesOf = kept(async (digest) => {
  const { width, height, text, base } = await fetched(`pictures/${digest}.js`, "windows-1252");
  const file = new Uint8Array(text.length);
  for (let i = 0; i < file.length; i++) file[i] = BYTES.get(text.charCodeAt(i));
  const blob = new Blob([file], { type: "image/webp" });
  const bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const { canvas, context } = newCanvas(width, height);
  context.drawImage(bitmap, 0, 0);
  const shown = context.getImageData(0, 0, width, height);
  if (base) {
    // The file holds what is to be added to the base's bytes, 128 for nothing; all is opaque.
    const { data } = await bytesOf(base);
    for (let i = 0; i < data.length; i++) {
      shown.data[i] = i % 4 === 3 ? 255 : (shown.data[i] + data[i] + 128) & 255;
    }
    context.putImageData(shown, 0, 0);
  }
  return { width, height, canvas, data: shown.data };
}, 24);

// A picture of 12 bits whose codes are told from another's, 128 for the same.
function toldFrom(other, { data, width, height }, digest) {
  const { canvas, context } = newCanvas(width, height), shown = context.createImageData(width, height);
  const codes = Uint16Array.from(other.codes, (code, i) => (i % 4 === 3 ? 255 : code + data[i] - 128));
  for (let i = 0; i < codes.length; i++) shown.data[i] = i % 4 === 3 ? 255 : Math.floor((codes[i] * 255) / other.full + 0.5);
  context.putImageData(shown, 0, 0);
  return { width, height, canvas, data: shown.data, digest, codes, full: other.full };
}

// A picture with its codes: RGBA at 4 * (y * width + x), from 0 to `full`; alpha stays a byte.
async function pictureOf({ digest, finer, delta: told, of }) {
  if (told) return toldFrom(await pictureOf(of), await bytesOf(told), digest);
  const shown = await bytesOf(digest);
  if (!finer) return { ...shown, digest, codes: shown.data, full: 255 };
  const { data } = await bytesOf(finer);
  const codes = Uint16Array.from(shown.data, (byte, i) =>
    i % 4 === 3 ? byte : Math.floor((byte * 4095) / 255 + 0.5) + data[i] - 128,
  );
  return { ...shown, digest, codes, full: 4095 };
}
