// What was sent, and where tool and brush are at a time. Columns are steps in 0.01 mm, ms and mrad.
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);

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
