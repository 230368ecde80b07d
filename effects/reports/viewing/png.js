// A PNG file that keeps every code: 8 bits a component, or 16 where a machine has more than 8.
// Source: PNG specification, second edition, sections 5 (chunks), 7.2 (most significant byte first), 9.2.

const CRC_TABLE = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

function crcOf(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = CRC_TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

function chunk(name, data) {
  const out = new Uint8Array(12 + data.length), view = new DataView(out.buffer);
  view.setUint32(0, data.length);
  for (let i = 0; i < 4; i++) out[4 + i] = name.charCodeAt(i);
  out.set(data, 8);
  view.setUint32(8 + data.length, crcOf(out.subarray(4, 8 + data.length)));
  return out;
}

// The file of a rectangle of a picture (codes.js), without alpha, as a Blob.
async function pngOf(picture, of = wholeOf(picture)) {
  const { width, height } = of, isDeep = picture.full > 255, step = isDeep ? 2 : 1;
  const rows = new Uint8Array(height * (1 + 3 * step * width)); // filter 0: none
  let place = 0;
  for (let y = 0; y < height; y++) {
    place++;
    for (let x = 0; x < width; x++) {
      const i = 4 * ((of.y + y) * picture.width + of.x + x);
      for (let c = 0; c < 3; c++) {
        const code = picture.codes[i + c];
        if (isDeep) {
          const scaled = Math.floor((code * 65535) / picture.full + 0.5);
          rows[place++] = scaled >> 8;
          rows[place++] = scaled & 255;
        } else rows[place++] = code;
      }
    }
  }
  const stream = new Blob([rows]).stream().pipeThrough(new CompressionStream("deflate"));
  const packed = new Uint8Array(await new Response(stream).arrayBuffer());
  const head = new Uint8Array(13), view = new DataView(head.buffer);
  view.setUint32(0, width);
  view.setUint32(4, height);
  head[8] = 8 * step;
  head[9] = 2; // red, green, blue
  const begin = Uint8Array.from([137, 80, 78, 71, 13, 10, 26, 10]);
  return new Blob([begin, chunk("IHDR", head), chunk("IDAT", packed), chunk("IEND", new Uint8Array())], { type: "image/png" });
}
