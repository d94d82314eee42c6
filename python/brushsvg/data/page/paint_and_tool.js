// Paint, the tool's way and the tool at a time.
// rows that are filled at once: no seams within, and few enough to be filled at every frame
const CHUNK = 64;

// Paint: finished strokes by their outline, the one that is being painted by what was swept so far
const showPaint = (now) => {
  const done = passes.length && ends[0] <= now.time ? lastAtMost(ends, now.time) + 1 : 0;
  if (done < donePasses) {
    clear(layers.done);
    donePasses = 0;
  }
  for (; donePasses < done; donePasses++) {
    const pass = passes[donePasses];
    pass.path ||= ringPath(pass.rings);
    layers.done.fillStyle = colourOf(pass);
    layers.done.fill(pass.path);
  }
  const number = now.chapter.pass, painting = number !== null && number >= done;
  clear(layers.fresh);
  if (startedPass !== (painting ? number : -1) || startedRow > now.row) {
    clear(layers.started);
    startedPass = painting ? number : -1;
    startedRow = now.chapter.first;
  }
  if (!painting) return;
  layers.started.fillStyle = layers.fresh.fillStyle = colourOf(passes[number]);
  const swept = (first, last) => {
    const path = new Path2D();
    for (let i = first; i <= last; i++)
      if (on[i]) addSwept(path, i > now.chapter.first && on[i - 1] ? brushAt(i - 1) : null, brushAt(i));
    return path;
  };
  for (; now.row - startedRow >= CHUNK; startedRow += CHUNK)
    layers.started.fill(swept(startedRow, startedRow + CHUNK - 1));
  const path = swept(startedRow, now.row);
  if (now.brush) addSwept(path, brushAt(now.row), now.brush);
  layers.fresh.fill(path);
};

// The TCP's way: on the paper a line, in the air dashes
const drawWay = (layer, first, last, tip) => {
  const paper = new Path2D(), air = new Path2D();
  let before = null;
  const step = (i, touching, x, y) => {
    const part = touching ? paper : air;
    if (part !== before) part.moveTo(X[i - 1], Y[i - 1]);
    part.lineTo(x, y);
    before = part;
  };
  for (let i = Math.max(first, 1); i <= last; i++) step(i, on[i] && on[i - 1], X[i], Y[i]);
  if (tip) step(last + 1, tip.brush, tip.x, tip.y);
  layer.strokeStyle = BLUE;
  layer.lineWidth = px(1.3);
  layer.globalAlpha = tip ? 1 : 0.65; // what is past steps back
  layer.stroke(paper);
  layer.globalAlpha = 0.35;
  layer.lineWidth = px(1);
  layer.setLineDash([px(4), px(5)]);
  layer.stroke(air);
  layer.setLineDash([]);
  layer.globalAlpha = 1;
};
const showWay = (now) => {
  const done = chapters.indexOf(now.chapter);
  if (done < doneChapters) {
    clear(layers.lines);
    doneChapters = 0;
  }
  for (; doneChapters < done; doneChapters++)
    drawWay(layers.lines, chapters[doneChapters].first, chapters[doneChapters].next - 1, null);
  if ($("path").checked) drawWay(layers.tool, now.chapter.first, now.row, now);
};

const showTool = (now) => {
  const layer = layers.tool;
  if (now.brush) {
    const patch = new Path2D();
    addRing(patch, footprint(now.brush));
    layer.fillStyle = "rgba(217, 98, 43, 0.28)";
    layer.fill(patch);
    layer.strokeStyle = layer.fillStyle = ORANGE;
    layer.lineWidth = px(1.6);
    layer.stroke(patch);
    layer.beginPath();
    layer.moveTo(now.brush.px, now.brush.py);
    layer.lineTo(now.x, now.y);
    layer.stroke();
    layer.beginPath();
    layer.arc(now.brush.px, now.brush.py, px(2.6), 0, 2 * Math.PI);
    layer.fill();
  }
  layer.beginPath();
  layer.arc(now.x, now.y, px(6), 0, 2 * Math.PI);
  layer.fillStyle = now.brush ? "#ffffff" : "rgba(255, 255, 255, 0.6)";
  layer.fill();
  layer.moveTo(now.x - px(9), now.y);
  layer.lineTo(now.x + px(9), now.y);
  layer.moveTo(now.x, now.y - px(9));
  layer.lineTo(now.x, now.y + px(9));
  layer.strokeStyle = BLUE;
  layer.lineWidth = px(1.6);
  layer.stroke();
};
