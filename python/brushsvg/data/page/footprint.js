// The footprint on the paper, and what it sweeps from one row to the next: see sweep.hpp.
const FLIPPED = 0.8; // cosine of a turn of the heading at once, in which nothing is swept

// Outline at a depth, as in footprint.hpp, laid on the paper
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
