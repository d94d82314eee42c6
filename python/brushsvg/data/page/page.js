"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const $ = (id) => document.getElementById(id);
  const BLUE = "#3f8fd9", ORANGE = "#d9622b", GREY = "#e4e2db", EDGE = "#d3d1ca", QUIET = "#6d717a";
  const CHUNK = 64; // rows that are filled at once: no seams within, and few enough to be filled at every frame
  const FLIPPED = 0.8; // cosine of a turn of the heading at once, in which nothing is swept

  // What was sent: columns of steps, in 0.01 mm, ms and mrad ---------------------------------------

  const sums = (steps, unit) => {
    const values = new Float64Array(steps.length);
    for (let i = 0, sum = 0; i < steps.length; i++) values[i] = (sum += steps[i]) / unit;
    return values;
  };
  const r = data.rows;
  const T = sums(r.t, 1000), X = sums(r.x, 100), Y = sums(r.y, 100), Z = sums(r.z, 100), on = sums(r.on, 1);
  const brushColumns = { px: sums(r.px, 100), py: sums(r.py, 100), heading: sums(r.heading, 1000),
    depth: sums(r.depth, 100), pull: sums(r.pull, 100), gap: sums(r.gap, 100) };
  const count = T.length, end = T[count - 1];
  const brushRow = new Int32Array(count); // where a row that touches the paper stands in the brush's columns
  for (let i = 0, k = 0; i < count; i++) brushRow[i] = on[i] ? k++ : -1;

  const ringPath = (rings) => {
    const path = new Path2D();
    for (const steps of rings) {
      let x = 0, y = 0;
      for (let i = 0; i < steps.length; i += 2) {
        x += steps[i] / 100;
        y += steps[i + 1] / 100;
        if (i) path.lineTo(x, y); else path.moveTo(x, y);
      }
      path.closePath();
    }
    return path;
  };
  const outline = ([depth, flat]) => ({ depth, points: Float64Array.from(flat, (v) => v / 1000) });
  const dragged = data.dragged.map(outline), pressed = data.pressed.map(outline);
  const corners = dragged[0].points.length / 2;
  const colourOf = (pass) => (/^#[0-9a-f]{6}$/i.test(pass.colour) ? pass.colour : "#000000");

  const chapters = data.chapters.map(([title, first, pass], k) => {
    const next = k + 1 < data.chapters.length ? data.chapters[k + 1][1] : count;
    return { title, first, next, pass };
  });
  const passes = data.passes.map((pass) => ({ ...pass, end: 0, chapter: null }));
  for (const chapter of chapters) {
    if (chapter.pass === null) continue;
    const pass = passes[chapter.pass];
    pass.chapter = chapter;
    let last = chapter.next - 1;
    while (last > chapter.first && !on[last]) last--;
    pass.end = T[Math.min(last, count - 1)];
  }

  // The brush at a time ----------------------------------------------------------------------------

  const lastAtMost = (values, value) => { // the last index whose value is not above it, at least 0
    let low = 0, high = values.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (values[middle] <= value) low = middle; else high = middle;
    }
    return low;
  };
  const starts = chapters.map((chapter) => chapter.first);
  const chapterOf = (row) => chapters[lastAtMost(starts, row)];
  const ends = passes.map((pass) => pass.end);

  const brushAt = (row) => {
    const k = brushRow[row], at = {};
    for (const name in brushColumns) at[name] = brushColumns[name][k];
    return at;
  };
  const turned = (a, b) => Math.atan2(Math.sin(b - a), Math.cos(b - a));
  const blend = (a, b, f) => {
    const at = {};
    for (const name in a) at[name] = a[name] + f * (b[name] - a[name]);
    at.heading = a.heading + f * turned(a.heading, b.heading);
    return at;
  };
  const stateAt = (time) => {
    const row = lastAtMost(T, time), next = Math.min(row + 1, count - 1);
    const f = T[next] > T[row] ? Math.min((time - T[row]) / (T[next] - T[row]), 1) : 0;
    const between = (V) => V[row] + f * (V[next] - V[row]);
    let brush = null;
    if (on[row]) {
      brush = brushAt(row);
      if (f > 0 && on[next]) brush = blend(brush, brushAt(next), f);
    }
    return { time, row, brush, x: between(X), y: between(Y), z: between(Z), chapter: chapterOf(row) };
  };

  // Outline at a depth, as footprint_at in footprint.hpp, laid on the paper
  const addBlend = (shapes, depth, weight, sum) => {
    let above = 0;
    while (above < shapes.length && shapes[above].depth < depth) above++;
    const add = (shape, share) => { for (let i = 0; i < sum.length; i++) sum[i] += share * shape.points[i]; };
    if (above === shapes.length) add(shapes[above - 1], weight);
    else if (above === 0) add(shapes[0], weight * depth / shapes[0].depth);
    else {
      const c = (depth - shapes[above - 1].depth) / (shapes[above].depth - shapes[above - 1].depth);
      add(shapes[above - 1], weight * (1 - c));
      add(shapes[above], weight * c);
    }
  };
  const footprint = (brush) => {
    const ring = new Float64Array(2 * corners), twoKinds = pressed.length > 0 && brush.pull < 1;
    addBlend(dragged, brush.depth, twoKinds ? brush.pull : 1, ring);
    if (twoKinds) addBlend(pressed, brush.depth, 1 - brush.pull, ring);
    const c = Math.cos(brush.heading), s = Math.sin(brush.heading);
    const x0 = brush.px - brush.gap * c, y0 = brush.py - brush.gap * s;
    for (let i = 0; i < ring.length; i += 2) {
      const x = ring[i], y = ring[i + 1];
      ring[i] = x0 + c * x - s * y;
      ring[i + 1] = y0 + s * x + c * y;
    }
    return ring;
  };
  const cross = (p, a, b, c) =>
    (p[b] - p[a]) * (p[c + 1] - p[a + 1]) - (p[b + 1] - p[a + 1]) * (p[c] - p[a]);
  const isConvex = (p) => {
    const size = Math.max(...p.map(Math.abs));
    for (let i = 0; i < p.length; i += 2)
      if (cross(p, i, (i + 2) % p.length, (i + 4) % p.length) < -1e-4 * size * size) return false;
    return true;
  };
  const allConvex = [...dragged, ...pressed].every((shape) => isConvex(shape.points));

  // What the footprint sweeps from one row to the next, all turning left: filled together they are one area
  const addRing = (path, ring) => {
    path.moveTo(ring[0], ring[1]);
    for (let i = 2; i < ring.length; i += 2) path.lineTo(ring[i], ring[i + 1]);
    path.closePath();
  };
  const hull = (a, b) => {
    const p = new Float64Array(a.length + b.length);
    p.set(a);
    p.set(b, a.length);
    const order = Array.from({ length: p.length / 2 }, (_, i) => 2 * i)
      .sort((i, j) => p[i] - p[j] || p[i + 1] - p[j + 1]);
    const half = (indices) => {
      const chain = [];
      for (const i of indices) {
        while (chain.length > 1 && cross(p, chain[chain.length - 2], chain[chain.length - 1], i) <= 0) chain.pop();
        chain.push(i);
      }
      return chain.slice(0, -1);
    };
    return [...half(order), ...half(order.reverse())].flatMap((i) => [p[i], p[i + 1]]);
  };
  const addSwept = (path, before, now) => {
    const a = before && footprint(before), b = footprint(now);
    const flipped = before && Math.cos(now.heading - before.heading) < FLIPPED;
    if (!before || flipped) return addRing(path, b);
    if (allConvex) return addRing(path, hull(a, b));
    addRing(path, b);
    for (let i = 0; i < a.length; i += 2) {
      const j = (i + 2) % a.length;
      const p = [a[i], a[i + 1], a[j], a[j + 1], b[j], b[j + 1], b[i], b[i + 1]];
      for (const [u, v, w] of [[0, 2, 4], [0, 4, 6]])
        addRing(path, (cross(p, u, v, w) < 0 ? [u, w, v] : [u, v, w]).flatMap((k) => [p[k], p[k + 1]]));
    }
  };

  // Layers: canvases over each other, each drawn again only when it has changed ---------------------

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
    for (const [name, x, y] of data.stations) {
      sheet.beginPath();
      sheet.arc(x, y, px(13), 0, 2 * Math.PI);
      sheet.fillStyle = "#ffffff";
      sheet.fill();
      sheet.stroke();
      sheet.save();
      sheet.translate(x, y - px(28));
      sheet.scale(px(1), -px(1));
      sheet.font = "13px system-ui, 'DejaVu Sans', sans-serif";
      sheet.textAlign = "center";
      sheet.fillStyle = QUIET;
      sheet.fillText(name, 0, 0);
      sheet.restore();
    }
    wanted.fillStyle = GREY;
    for (const path of wantedPaths) wanted.fill(path);
    donePasses = doneChapters = 0;
    startedPass = -1;
    show();
  };

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

  // Controls ---------------------------------------------------------------------------------------

  const clockText = (time) => {
    const tenths = Math.floor(time * 10 + 1e-6), seconds = (tenths % 600) / 10;
    return `${Math.floor(tenths / 600)}:${seconds < 10 ? "0" : ""}${seconds.toFixed(1)}`;
  };
  const heights = { up: Z.reduce((a, b) => Math.max(a, b), 1e-3), down: -Z.reduce((a, b) => Math.min(a, b), -1e-3) };

  const showWords = (now) => {
    $("slider").value = now.time;
    $("slider").setAttribute("aria-valuetext", clockText(now.time));
    $("clock").textContent = `${clockText(now.time)} / ${clockText(end)}`;
    $("what").textContent = now.chapter.title;
    const pause = data.pauses.find(([from, to]) => from <= now.time && now.time < to);
    const height = Math.abs(now.z).toFixed(1);
    $("how").textContent = pause ? pause[2]
      : now.brush ? `pressed ${height} mm deep`
      : now.z < 0 ? `${height} mm lower than the paper` : `${height} mm above the paper`;
    const share = now.z > 0 ? 0.5 - 0.42 * now.z / heights.up : 0.5 - 0.42 * now.z / heights.down;
    $("needle").style.top = `${(100 * share).toFixed(1)}%`;
    $("needle").classList.toggle("on", Boolean(now.brush));
  };

  let time = 0, playing = false, lastFrame = null;
  const show = () => {
    const now = stateAt(time);
    clear(layers.tool);
    showPaint(now);
    showWay(now);
    showTool(now);
    showWords(now);
  };
  const goTo = (target) => {
    time = Math.min(Math.max(target, 0), end);
    show();
  };
  const play = (wish) => {
    playing = wish;
    if (playing && time >= end) time = 0;
    lastFrame = null;
    $("sign").setAttribute("d", playing ? "M7 5h4v14H7zM13 5h4v14h-4z" : "M8 5v14l11-7z");
    $("play").setAttribute("aria-label", playing ? "pause" : "play");
    if (playing) requestAnimationFrame(frame);
  };
  const frame = (stamp) => {
    if (!playing) return;
    if (lastFrame !== null) goTo(time + Math.min((stamp - lastFrame) / 1000, 0.25) * Number($("speed").value));
    lastFrame = stamp;
    if (time >= end) play(false); else requestAnimationFrame(frame);
  };
  const jump = (by) => { // to the start of this stroke, the one before or the next
    const k = chapters.indexOf(stateAt(time).chapter), start = T[chapters[k].first];
    const target = chapters[by > 0 ? k + 1 : time - start > 0.5 ? k : Math.max(k - 1, 0)];
    goTo(target && target.first < count ? T[target.first] : end);
  };
  const keys = {
    " ": () => play(!playing),
    ArrowRight: () => goTo(time + Number($("speed").value)),
    ArrowLeft: () => goTo(time - Number($("speed").value)),
    ArrowDown: () => jump(1),
    ArrowUp: () => jump(-1),
    Home: () => goTo(0),
    End: () => goTo(end),
  };
  window.addEventListener("keydown", (event) => {
    const act = keys[event.key], at = event.target;
    if (!act || event.ctrlKey || event.altKey || event.metaKey || at === $("speed")) return;
    if (event.key === " " && (at.type === "checkbox" || at === $("play"))) return; // theirs
    event.preventDefault();
    act();
  });
  $("play").addEventListener("click", () => play(!playing));
  $("stage").addEventListener("click", () => play(!playing));
  $("slider").addEventListener("input", () => goTo(Number($("slider").value)));
  let bare = false;
  const choose = () => {
    const shown = { wanted: !bare && $("wanted").checked, lines: !bare && $("path").checked, tool: !bare };
    for (const name in shown) layers[name].canvas.style.visibility = shown[name] ? "" : "hidden";
    show();
  };
  $("wanted").addEventListener("change", choose);
  $("path").addEventListener("change", choose);

  const readAddress = () => { // #t=12.5 a moment to look at, #t=12.5&bare the paint alone
    const asked = new URLSearchParams(location.hash.slice(1)), moment = Number(asked.get("t"));
    bare = asked.has("bare");
    if (asked.has("t")) play(false);
    if (asked.has("t") && Number.isFinite(moment)) time = Math.min(Math.max(moment, 0), end);
    choose();
  };
  window.addEventListener("hashchange", readAddress);

  const [width, height] = data.sheet.map((side) => Number(side.toFixed(1)));
  const strokes = passes.length === 1 ? "1 stroke" : `${passes.length} strokes`;
  document.title = $("title").textContent = data.title || "Brush strokes";
  $("about").textContent = `${strokes} with brush ${data.brush}, sheet ${width} \u00d7 ${height} mm`;
  $("for-wanted").hidden = data.wanted.length === 0;
  $("slider").max = end;
  for (const speed of [...new Set([0.5, 1, 2, 5, 10, 20, 50, data.speed])].sort((a, b) => a - b))
    $("speed").add(new Option(`${speed}\u00d7`, speed, false, speed === data.speed));
  layOut();
  readAddress();
  new ResizeObserver(layOut).observe($("stage"));
})();
