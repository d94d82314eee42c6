// Slider, clock, words and keys.

const clockText = (time) => {
  const tenths = Math.floor(time * 10 + 1e-6), minutes = Math.floor(tenths / 600) % 60, hours = Math.floor(tenths / 36000);
  const two = (number) => String(number).padStart(2, "0");
  const seconds = ((tenths % 600) / 10).toFixed(1).padStart(4, "0");
  return end < 3600 ? `${minutes}:${seconds}` : `${hours}:${two(minutes)}:${seconds}`;
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
