// Canvases over each other, each drawn again only when it has changed.
const $ = (id) => document.getElementById(id);
const BLUE = "#3f8fd9", ORANGE = "#d9622b", GREY = "#e4e2db", EDGE = "#d3d1ca", QUIET = "#6d717a";

const layers = {};
for (const name of ["sheet", "wanted", "done", "started", "fresh", "lines", "tool"]) {
  const canvas = document.createElement("canvas");
  $("stage").append(canvas);
  layers[name] = canvas.getContext("2d");
}
const view = { scale: 1, ratio: 1, left: 0, top: 0 };
let donePasses = 0, doneChapters = 0, startedPass = -1, startedRow = 0;

const bounds = (() => {
  const box = [0, 0, ...data.sheet];
  const hold = (x, y, room) => {
    box[0] = Math.min(box[0], x - room);
    box[1] = Math.min(box[1], y - room);
    box[2] = Math.max(box[2], x + room);
    box[3] = Math.max(box[3], y + room);
  };
  for (let i = 0; i < count; i++) hold(X[i], Y[i], 0);
  for (const [, x, y] of data.stations) hold(x, y, 10);
  const pad = 0.015 * Math.max(box[2] - box[0], box[3] - box[1]);
  return [box[0] - pad, box[1] - pad, box[2] + pad, box[3] + pad];
})();

const clear = (layer) => {
  layer.setTransform(1, 0, 0, 1, 0, 0);
  layer.clearRect(0, 0, layer.canvas.width, layer.canvas.height);
  layer.setTransform(view.scale, 0, 0, -view.scale, view.left, view.top);
  layer.lineJoin = layer.lineCap = "round";
};
const px = (size) => size * view.ratio / view.scale; // mm of so many px of the page

const wantedPaths = data.wanted.map(ringPath);
const layOut = () => {
  const { clientWidth, clientHeight } = $("stage");
  view.ratio = Math.min(window.devicePixelRatio || 1, 2);
  const width = Math.round(clientWidth * view.ratio), height = Math.round(clientHeight * view.ratio);
  const [x0, y0, x1, y1] = bounds;
  view.scale = Math.max(Math.min(width / (x1 - x0), height / (y1 - y0)), 1e-6);
  view.left = Math.round((width - (x0 + x1) * view.scale) / 2); // whole px: the sheet's corner stays sharp
  view.top = Math.round((height + (y0 + y1) * view.scale) / 2);
  for (const name in layers) {
    const { canvas } = layers[name];
    canvas.width = width;
    canvas.height = height;
    canvas.style.width = `${width / view.ratio}px`;
    canvas.style.height = `${height / view.ratio}px`;
    clear(layers[name]);
  }
  const { sheet, wanted } = layers, [w, h] = data.sheet;
  sheet.fillStyle = "#ffffff";
  sheet.fillRect(0, 0, w, h);
  sheet.strokeStyle = EDGE;
  sheet.lineWidth = px(1);
  sheet.strokeRect(-px(0.5), -px(0.5), w + px(1), h + px(1));
  const round = Math.min(px(13), 4); // of vessels, which are never so large on paper that they hide each other
  sheet.fillStyle = "#ffffff";
  for (const [, x, y] of data.stations) {
    sheet.beginPath();
    sheet.arc(x, y, round, 0, 2 * Math.PI);
    sheet.fill();
    sheet.stroke();
  }
  sheet.font = "13px system-ui, 'DejaVu Sans', sans-serif";
  sheet.textAlign = "center";
  sheet.fillStyle = QUIET;
  const [left, right] = [-view.left, width - view.left].map((edge) => edge / view.ratio);
  for (const [name, x, y] of data.stations) {
    const half = sheet.measureText(name).width / 2;
    sheet.save();
    sheet.translate(0, y - round - px(14));
    sheet.scale(px(1), -px(1));
    sheet.fillText(name, Math.max(left + half, Math.min(right - half, x / px(1))), 0); // all of it on the page
    sheet.restore();
  }
  wanted.fillStyle = GREY;
  for (const path of wantedPaths) wanted.fill(path);
  donePasses = doneChapters = 0;
  startedPass = -1;
  show();
};
