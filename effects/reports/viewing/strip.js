// A strip of crops: one place of many pictures side by side, enlarged by a whole number, without smoothing.
//
// show(crops, zoom) takes [{name, canvas, x, y, width, height}], the last four a rectangle of the canvas.

const CROP_GAP = 8, CROP_LINE = 18; // CSS pixels between crops, and of a line below one

function makeStrip() {
  const element = el("div", { class: "strip", hidden: true });
  let shown = [], by = 4;

  function enlarged({ canvas: picture, x, y, width, height }, zoom) {
    const { canvas, context } = newCanvas(width * zoom, height * zoom);
    context.imageSmoothingEnabled = false;
    context.drawImage(picture, x, y, width, height, 0, 0, width * zoom, height * zoom);
    return canvas;
  }
  function show(crops, zoom) {
    [shown, by] = [crops, zoom];
    element.hidden = !crops.length;
    element.replaceChildren(...crops.map((crop) =>
      el("figure", { "data-crop": crop.name }, enlarged(crop, zoom), el("figcaption", { style: `max-width:${crop.width * zoom}px` }, crop.name))));
  }
  // A name in lines as wide as a crop.
  function broken(context, text, width) {
    const lines = [""];
    for (const word of text.split(" ")) {
      const longer = lines[lines.length - 1] ? `${lines[lines.length - 1]} ${word}` : word;
      if (context.measureText(longer).width <= width) lines[lines.length - 1] = longer;
      else if (lines[lines.length - 1]) lines.push(word);
      else lines[lines.length - 1] = word;
    }
    return lines;
  }
  // The strip as a PNG on white: crops with their names in black below them.
  function save() {
    const font = `13px ${getComputedStyle(element).fontFamily}`;
    const { context: ruler } = newCanvas(1, 1);
    ruler.font = font;
    const names = shown.map((crop) => broken(ruler, crop.name, crop.width * by));
    const lines = Math.max(...names.map((one) => one.length)), high = Math.max(...shown.map((crop) => crop.height * by));
    const width = shown.reduce((sum, crop) => sum + crop.width * by + CROP_GAP, -CROP_GAP);
    const { canvas, context } = newCanvas(width, high + CROP_LINE * lines + 4);
    context.fillStyle = "#fff";
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.font = font;
    context.textBaseline = "middle";
    let left = 0;
    shown.forEach((crop, n) => {
      context.drawImage(enlarged(crop, by), left, 0);
      context.fillStyle = "#000";
      names[n].forEach((line, row) => context.fillText(line, left, high + CROP_LINE * (row + 0.5) + 4, crop.width * by));
      left += crop.width * by + CROP_GAP;
    });
    return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
  }
  return { element, show, save };
}
