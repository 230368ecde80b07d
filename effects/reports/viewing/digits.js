// The numbers of pixels, written into them: red, green and blue in three rows, where a pixel is shown with 16
// device pixels or more.

const LEAST_SCALE = 16;
// Digits of 3 x 5 dots, from the top, three bits a row: no font can be read at this size.
const DOTS = {
  0: [7, 5, 5, 5, 7], 1: [2, 6, 2, 2, 7], 2: [7, 1, 7, 4, 7], 3: [7, 1, 3, 1, 7], 4: [5, 5, 7, 1, 1],
  5: [7, 4, 7, 1, 7], 6: [7, 4, 7, 5, 7], 7: [7, 1, 2, 2, 2], 8: [7, 5, 7, 5, 7], 9: [7, 5, 7, 1, 7],
  "-": [0, 0, 7, 0, 0],
};
// Of the rows, on dark and on light pixels: rows that touch are told apart by their color.
const ON_DARK = ["#ffb3ad", "#a5efac", "#b9ccff"], ON_LIGHT = ["#8c0000", "#004d0b", "#0a1c9c"];

// Writes three whole numbers into a square of the canvas. `isLight`: the square is light.
function writeNumbers(context, numbers, left, top, edge, isLight) {
  const wide = Math.max(...numbers.map((number) => String(number).length)) * 4 - 1;
  const dot = Math.floor(Math.min((edge - 1) / wide, (edge - 1) / 15));
  if (dot < 1) return;
  const pitch = 17 * dot < edge ? 6 * dot : 5 * dot;
  let y = top + Math.floor((edge - 2 * pitch - 5 * dot) / 2);
  numbers.forEach((number, row) => {
    const text = String(number);
    let x = left + Math.floor((edge - dot * (4 * text.length - 1)) / 2);
    context.fillStyle = (isLight ? ON_LIGHT : ON_DARK)[row];
    for (const character of text) {
      DOTS[character].forEach((bits, down) => {
        for (let along = 0; along < 3; along++) {
          if (bits & (4 >> along)) context.fillRect(x + along * dot, y + down * dot, dot, dot);
        }
      });
      x += 4 * dot;
    }
    y += pitch;
  });
}
