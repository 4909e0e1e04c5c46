"use strict";
// One state for the whole page: the frame that is shown and the track that is selected. Whatever is hovered,
// clicked or typed changes the state; every view then draws it.
const data = JSON.parse(document.getElementById("data").textContent);
const frames = data.frames, tracks = data.tracks;
const trackOf = new Map(tracks.map((track) => [track.id, track]));
const pictured = frames.flatMap((frame, k) => (frame.uri ? [k] : []));
const steps = pictured.length ? pictured : frames.map((_, k) => k); // the frames that the slider goes over
const views = []; // each with draw(), after a change of size or selection, and mark(), after a change of the frame
let step = Math.max(steps.indexOf(data.shown), 0);
let selected = null; // id of a track
let timer = null;

const byId = (id) => document.getElementById(id);
const now = () => frames[steps[step]];
const least = (items, cost) => items.reduce((best, item) => (cost(item) < cost(best) ? item : best));
const metres = (value) => (value < 10 ? value.toFixed(1) : value.toFixed(0)) + " m";

function node(tag, attributes, parent, text) {
  const svg = ["svg", "g", "path", "line", "rect", "circle", "ellipse", "text", "clipPath", "title"].includes(tag);
  const element = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

// ---- state ----

function show(position) {
  step = Math.min(Math.max(position, 0), steps.length - 1);
  for (const view of views) view.mark();
}

function showFrame(k) { // the step next to this frame
  stop();
  show(steps.indexOf(least(steps, (frame) => Math.abs(frame - k))));
}

function select(id) {
  selected = id;
  const track = trackOf.get(id);
  if (track && !track.points.some((point) => point[0] === steps[step])) { // go where it can be seen
    const seen = track.points.map((point) => point[0]).filter((k) => steps.includes(k));
    if (seen.length) showFrame(least(seen, (k) => Math.abs(k - steps[step])));
  }
  for (const view of views) { view.draw(); view.mark(); }
}

function stop() {
  clearInterval(timer);
  timer = null;
  byId("play").textContent = "▶ Play";
}

function toggle() {
  if (timer) return stop();
  byId("play").textContent = "❚❚ Pause";
  timer = setInterval(() => show((step + 1) % steps.length), data.stills ? 1500 : 150);
}

// ---- the picture, its controls and what is said of the frame ----

function describe(frame) {
  const parts = [data.unit + " " + frame.n];
  if (!data.stills) parts.push(frame.t.toFixed(1) + " s");
  parts.push(frame.obstacles + (frame.obstacles === 1 ? " obstacle" : " obstacles"));
  const hit = frame.hit;
  if (hit) {
    const left = hit.s === null ? "" : ", " + hit.s.toFixed(1) + " s left";
    parts.push((data.stills ? "in the collision volume: " : "collision warning: ") + hit.name + " at " + metres(hit.m) + left);
  } else if (frame.state !== "blind") {
    parts.push(data.stills ? "nothing found in the collision volume" : "no collision warning");
  }
  if (frame.state === "blind") parts.push("blind: nothing found does not mean free space");
  if (!data.stills && !frame.known) parts.push("own motion unknown");
  return parts.join(" · ");
}

function viewer() {
  const stage = byId("stage"), image = byId("picture"), slider = byId("slider");
  const tabs = [...document.querySelectorAll("#tabs button")];
  let tile = stage && stage.clientWidth < 700 ? 0 : null; // null: all four
  const overlay = stage && node("svg", { class: "finder" }, stage);

  function draw() {
    if (!stage) return;
    const [panelWidth, panelHeight] = data.panel;
    const box = tile === null ? [0, 0, panelWidth, panelHeight] : data.tiles[tile];
    crop(stage, image, box);
    overlay.setAttribute("viewBox", box.join(" "));
    tabs.forEach((tab) => tab.setAttribute("aria-pressed", String(tab.dataset.tile === String(tile ?? ""))));
  }

  function mark() {
    const frame = now();
    if (slider) slider.value = step;
    byId("frame").textContent = data.unit + " " + frame.n;
    byId("says").textContent = describe(frame);
    byId("says").className = frame.hit ? "hit" : frame.state;
    byId("why").textContent = frame.why;
    const track = trackOf.get(selected);
    const point = track && track.points.find((p) => p[0] === steps[step]);
    byId("chosen").textContent = !track ? "" :
      track.name + " selected" + (point ? ": " + metres(point[1]) + " away" : ": not in this frame") + " (Esc: none)";
    if (!stage) return;
    if (image.src !== frame.uri) image.src = frame.uri;
    overlay.replaceChildren();
    data.tiles.forEach(([left, top, width, height], k) => {
      const clip = node("clipPath", { id: "tile" + k }, overlay);
      node("rect", { x: left, y: top, width, height }, clip);
      const group = node("g", { "clip-path": "url(#tile" + k + ")" }, overlay);
      for (const [id, u, v, a, b, angle, text] of frame.ellipses) {
        const at = { cx: left + u, cy: top + v, rx: Math.max(a, 6), ry: Math.max(b, 6) };
        const turn = { transform: "rotate(" + [angle, at.cx, at.cy].join(" ") + ")" };
        if (id === selected) node("ellipse", { ...at, ...turn, class: "halo" }, group);
        const ellipse = node("ellipse", { ...at, ...turn, "data-track": id, class: id === selected ? "selected" : "" }, group);
        node("title", {}, ellipse, text);
        ellipse.addEventListener("click", () => select(id === selected ? null : id));
      }
    });
  }

  tabs.forEach((tab) => tab.addEventListener("click", () => {
    tile = tab.dataset.tile === "" ? null : Number(tab.dataset.tile);
    draw();
  }));
  if (slider) slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
  byId("play").addEventListener("click", toggle);
  return { draw, mark };
}

function crop(frame, image, [left, top, width, height]) { // shows this part of the panel, as wide as the frame
  frame.style.aspectRatio = width + " / " + height;
  image.style.width = 100 * data.panel[0] / width + "%";
  image.style.left = -100 * left / width + "%";
  image.style.top = -100 * top / height + "%";
}

// ---- a strip below the slider: which frames have a warning, and where the view or the motion tells nothing ----

function strip() {
  const host = byId("strip");
  const rows = [
    (frame) => (frame.hit ? "hit" : ""), (frame) => (frame.state === "healthy" ? "" : frame.state),
    (frame) => (frame.known ? "" : "unknown"),
  ].filter((kind) => frames.some(kind));
  const picture = node("svg", { preserveAspectRatio: "none", viewBox: `0 0 ${frames.length} ${4 * Math.max(rows.length, 1)}` }, host);
  picture.style.height = 12 * Math.max(rows.length, 1) + "px";
  node("rect", { width: frames.length, height: "100%", class: "ground" }, picture);
  rows.forEach((kind, row) => frames.forEach((frame, k) => {
    if (kind(frame)) node("rect", { x: k, y: 4 * row, width: 1, height: 3.4, class: kind(frame), "data-frame": frame.n }, picture);
  }));
  const cursor = node("rect", { width: Math.max(0.3, frames.length / 400), height: "100%", class: "cursor" }, picture);
  follow(picture, (x) => showFrame(Math.floor(x / picture.clientWidth * frames.length)));
  return { draw() {}, mark() { cursor.setAttribute("x", steps[step] + 0.35); } };
}

function follow(element, hover, click) { // the pointer, in px of the element
  const at = (event) => {
    const box = element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  element.addEventListener("pointermove", (event) => hover(...at(event)));
  element.addEventListener("click", (event) => { hover(...at(event)); if (click) click(...at(event)); });
}

// ---- charts ----

const MARGIN = { left: 46, right: 46, top: 10, bottom: 36 };
const LABEL_HEIGHT = 13;
const MAX_LABELS = 16; // of tracks that were on no collision course
const colourOf = (id) => `hsl(${(40 + (id * 137.508) % 285).toFixed(0)} 65% var(--track))`; // no hue near red

function ticks(low, high, count) {
  const rough = (high - low) / Math.max(count, 1), decade = 10 ** Math.floor(Math.log10(rough));
  const size = [1, 2, 5, 10].map((factor) => factor * decade).find((value) => value >= rough * 0.999);
  const first = Math.ceil(low / size - 1e-9), values = [];
  for (let k = first; k * size <= high + 1e-9 * size; k++) values.push(Number((k * size).toPrecision(12)));
  return values;
}

const ruler = document.createElement("canvas").getContext("2d");
const textWidth = (text) => { ruler.font = "11px system-ui, sans-serif"; return ruler.measureText(text).width * 1.08; };

// Places each label where it covers no other: beside its point, else further away with a line, else nowhere.
function placeLabels(group, labels, width, height, busy) {
  const placed = busy.map(([x, y]) => [x - 4, y - 4, x + 4, y + 4]);
  for (const { x, y, text, colour, id } of labels) {
    const wide = textWidth(text), right = x + 6, before = x - 6 - wide;
    const spots = [[right, 0], [right, -1], [right, 1], [before, 0], [before, -1], [before, 1], [right, -2], [right, 2], [before, -2], [before, 2], [right, -3], [right, 3]];
    for (const [left, away] of spots) {
      const base = y + 4 + away * LABEL_HEIGHT;
      const box = [left - 2, base - LABEL_HEIGHT + 2, left + wide + 2, base + 3];
      const inside = box[0] >= 0 && box[1] >= 0 && box[2] <= width && box[3] <= height;
      if (!inside || placed.some((o) => box[0] < o[2] && o[0] < box[2] && box[1] < o[3] && o[1] < box[3])) continue;
      placed.push(box);
      if (away) node("line", { x1: x, y1: y, x2: left < x ? left + wide : left, y2: base - 4, class: "lead", style: "stroke:" + colour }, group);
      node("text", { x: left, y: base, class: "label", "data-track": id, style: "fill:" + colour }, group, text);
      break;
    }
  }
}

// series: {id, kind, points: [[x, y, frame]]}; kind "line" belongs to track id, "hit" are red dots, "plain" a line, "path" the camera.
function chart(id, { title, x: xName, y: yName, series, height, equal = false, low = null, high = null, empty = "", spreads = [] }) {
  const host = byId(id);
  if (!host) return;
  const picture = node("svg", { class: "chart", role: "img", "aria-label": title }, host);
  const points = series.flatMap((one) => one.points.map((point) => ({ track: one.id, x: point[0], y: point[1], frame: point[2] })));
  let toPx, area, cursor;

  function limits(values, fixedLow, fixedHigh) {
    let from = fixedLow ?? Math.min(...values), to = fixedHigh ?? Math.max(...values);
    if (!(to > from)) { from -= fixedLow === null ? 0.5 : 0; to = from + 1; }
    return [from, fixedHigh === null ? to + 0.03 * (to - from) : to];
  }

  function draw() {
    const width = Math.max(host.clientWidth, 200), tall = height(width);
    area = { left: MARGIN.left, right: width - MARGIN.right, top: MARGIN.top, bottom: tall - MARGIN.bottom };
    let [x0, x1] = limits(equal ? points.map((p) => p.x) : frames.map((f) => f.t), equal ? null : 0, equal ? null : Math.max(frames.at(-1).t, 0.1));
    let [y0, y1] = limits(points.map((p) => p.y).concat(points.length ? [] : [0, 1]), low, high);
    if (equal) { // one scale for both axes
      const scale = Math.max((x1 - x0) / (area.right - area.left), (y1 - y0) / (area.bottom - area.top));
      const growX = scale * (area.right - area.left) - (x1 - x0), growY = scale * (area.bottom - area.top) - (y1 - y0);
      [x0, x1, y0, y1] = [x0 - growX / 2, x1 + growX / 2, y0 - growY / 2, y1 + growY / 2];
    }
    toPx = (x, y) => [area.left + (x - x0) / (x1 - x0) * (area.right - area.left), area.bottom - (y - y0) / (y1 - y0) * (area.bottom - area.top)];
    picture.setAttribute("viewBox", `0 0 ${width} ${tall}`);
    picture.style.height = tall + "px";
    picture.replaceChildren();
    node("title", {}, picture, title);
    const axes = node("g", { class: "axes" }, picture);
    if (!equal) frames.forEach((frame, k) => {
      if (frame.state === "healthy") return;
      const from = toPx(frame.t, 0)[0], to = toPx(frames[k + 1]?.t ?? frame.t + 0.1, 0)[0];
      node("rect", { x: from, y: area.top, width: Math.max(Math.min(to, area.right) - from, 1), height: area.bottom - area.top, class: "band " + frame.state }, axes);
    });
    for (const value of ticks(x0, x1, (area.right - area.left) / 70)) {
      const px = toPx(value, y0)[0];
      rule(axes, true, px, [area.top, area.bottom], value, "middle", px, area.bottom + 15);
    }
    for (const value of ticks(y0, y1, (area.bottom - area.top) / 38)) {
      const py = toPx(x0, value)[1];
      rule(axes, false, py, [area.left, area.right], value, "end", area.left - 6, py + 4);
    }
    node("text", { x: (area.left + area.right) / 2, y: tall - 4, "text-anchor": "middle", class: "name" }, axes, xName);
    node("text", { transform: `translate(11 ${(area.top + area.bottom) / 2}) rotate(-90)`, "text-anchor": "middle", class: "name" }, axes, yName);
    if (!points.length && empty) node("text", { x: (area.left + area.right) / 2, y: (area.top + area.bottom) / 2, "text-anchor": "middle", class: "name" }, axes, empty);
    const pxPerMetre = toPx(1, 0)[0] - toPx(0, 0)[0];
    for (const { id: track, x, y, a, b, angle } of spreads) {
      const [cx, cy] = toPx(x, y);
      node("ellipse", { cx, cy, rx: a * pxPerMetre, ry: b * pxPerMetre, transform: `rotate(${-angle} ${cx} ${cy})`, class: dim(track) + "spread", style: "fill:" + colourOf(track) }, picture);
    }
    const labels = [];
    for (const { id: track, kind, points: own } of series) {
      const at = own.map(([x, y]) => toPx(x, y));
      if (!at.length) continue;
      const style = kind === "line" ? "stroke:" + colourOf(track) : "";
      if (kind === "hit") for (const [cx, cy] of at) node("circle", { cx, cy, r: 3, class: "hit" }, picture);
      else node("path", { d: "M" + at.map(([x, y]) => x.toFixed(1) + " " + y.toFixed(1)).join("L") + (at.length > 1 ? "" : "h0.1"),
        class: dim(track) + kind + (track !== undefined && track === selected ? " selected" : ""), style, ...(track === undefined ? {} : { "data-track": track }) }, picture);
      if (kind === "line") labels.push({ x: at.at(-1)[0], y: at.at(-1)[1], text: trackOf.get(track).name, colour: colourOf(track), id: track, rank: [track === selected ? 0 : 1, trackOf.get(track).hit ? 0 : 1, -own.length] });
    }
    labels.sort((a, b) => a.rank[0] - b.rank[0] || a.rank[1] - b.rank[1] || a.rank[2] - b.rank[2]);
    const course = labels.filter((label) => label.rank[0] + label.rank[1] < 2).length;
    placeLabels(node("g", {}, picture), labels.slice(0, course + MAX_LABELS), width, area.bottom,
      series.flatMap(({ kind, points: own }) => (kind === "line" ? [] : own.map(([x, y]) => toPx(x, y)))));
    cursor = node("g", { class: "cursor" }, picture);
  }

  function mark() {
    cursor.replaceChildren();
    const frame = now();
    if (!equal) {
      const px = toPx(frame.t, 0)[0];
      node("line", { x1: px, x2: px, y1: area.top, y2: area.bottom }, cursor);
    }
    for (const { id: track, kind, points: own } of series) {
      const point = own.find((one) => one[2] === steps[step]);
      if (!point) continue;
      const [cx, cy] = toPx(point[0], point[1]);
      const look = kind === "line" ? "fill:" + colourOf(track) : "";
      node("circle", { cx, cy, r: track !== undefined && track === selected ? 6 : kind === "path" ? 5 : 3.5, class: dim(track) + kind, style: look }, cursor);
    }
  }

  function fromLine(own, x, y) { // the distance to the line through these points, px
    const at = own.map((point) => toPx(point[0], point[1]));
    return Math.min(...at.map(([bx, by], k) => {
      const [ax, ay] = at[Math.max(k - 1, 0)], long = (bx - ax) ** 2 + (by - ay) ** 2;
      const share = long ? Math.min(Math.max(((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / long, 0), 1) : 0;
      return Math.hypot(ax + share * (bx - ax) - x, ay + share * (by - ay) - y);
    }));
  }

  follow(picture, (x, y) => {
    if (!equal) return showFrame(frames.indexOf(least(frames, (frame) => Math.abs(toPx(frame.t, 0)[0] - x))));
    const away = (point) => { const [px, py] = toPx(point.x, point.y); return Math.hypot(px - x, py - y); };
    const point = least(points, away);
    if (away(point) < 40) showFrame(point.frame);
  }, (x, y) => { // within a finger's width
    const near = series.filter((one) => one.id !== undefined && fromLine(one.points, x, y) < 20);
    if (near.length || selected !== null) select(near.length ? least(near, (one) => fromLine(one.points, x, y)).id : null);
  });
  addChart(host, { draw, mark });
}

function addChart(host, view) { // a view that is drawn anew with each change of its size
  views.push(view);
  new ResizeObserver(() => { view.draw(); view.mark(); }).observe(host);
}

function rule(axes, vertical, at, [from, to], text, anchor, x, y) { // a line of the grid with its number
  node("line", vertical ? { x1: at, x2: at, y1: from, y2: to } : { x1: from, x2: to, y1: at, y2: at }, axes);
  node("text", { x, y, "text-anchor": anchor }, axes, text);
}

const dim = (track) => (selected !== null && track !== undefined && track !== selected ? "dim " : "");

// A box from the lower to the upper quartile with the median, whiskers to the lowest value and to p99.
function stageChart() {
  const host = byId("stages"), rows = data.stages, pitch = 22;
  const picture = node("svg", { class: "chart", role: "img", "aria-label": "Time of each stage" }, host);
  const left = 96, most = Math.max(...rows.flatMap((row) => [row.p99, row.q3]), 0.1) * 1.04;
  let toPx, marks;

  function draw() {
    const width = Math.max(host.clientWidth, 200), bottom = rows.length * pitch + 6;
    toPx = (ms) => left + Math.min(ms, most) / most * (width - left - 12);
    picture.setAttribute("viewBox", `0 0 ${width} ${bottom + 36}`);
    picture.style.height = bottom + 36 + "px";
    picture.replaceChildren();
    const axes = node("g", { class: "axes" }, picture);
    for (const value of ticks(0, most, (width - left) / 60)) rule(axes, true, toPx(value), [0, bottom], value, "middle", toPx(value), bottom + 15);
    node("text", { x: (left + width) / 2, y: bottom + 32, "text-anchor": "middle", class: "name" }, axes, "ms per " + data.unit);
    rows.forEach((row, k) => {
      const y = k * pitch + pitch / 2, box = node("g", { class: ["host", "total"].includes(row.name) ? "box sum" : "box" }, picture);
      node("text", { x: left - 8, y: y + 4, "text-anchor": "end" }, axes, row.name);
      node("line", { x1: toPx(row.low), x2: toPx(row.p99), y1: y, y2: y }, box);
      node("rect", { x: toPx(row.q1), width: Math.max(toPx(row.q3) - toPx(row.q1), 1), y: y - 6, height: 12 }, box);
      node("line", { x1: toPx(row.median), x2: toPx(row.median), y1: y - 6, y2: y + 6, class: "median" }, box);
    });
    marks = node("g", { class: "cursor" }, picture);
  }

  function mark() {
    marks.replaceChildren();
    rows.forEach((row, k) => {
      const value = now().ms[k];
      if (value !== null) node("circle", { cx: toPx(value), cy: k * pitch + pitch / 2, r: 4 }, marks);
    });
  }
  addChart(host, { draw, mark });
}

// ---- tables: a click on a heading sorts, a click on a row selects ----

function table(id, current, choose) {
  const host = byId(id);
  if (!host) return;
  const body = host.tBodies[0], rows = [...body.rows];
  const headings = [...host.tHead.rows[0].cells];
  headings.forEach((heading, column) => heading.firstElementChild.addEventListener("click", () => {
    const up = heading.getAttribute("aria-sort") === "ascending";
    headings.forEach((other) => other.removeAttribute("aria-sort"));
    heading.setAttribute("aria-sort", up ? "descending" : "ascending");
    const value = (row) => Number(row.cells[column].dataset.value);
    body.append(...rows.sort((a, b) => (up ? value(b) - value(a) : value(a) - value(b))));
  }));
  const key = (row) => Number(row.dataset.key);
  for (const row of rows) {
    row.addEventListener("click", () => choose(key(row)));
    row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(key(row)); });
  }
  let last = null;
  const mark = () => {
    if (current() === last) return;
    last = current();
    for (const row of rows) row.setAttribute("aria-selected", String(key(row) === last));
  };
  views.push({ draw() {}, mark });
}

function gallery() {
  const host = byId("gallery"), buttons = [];
  steps.forEach((k, position) => {
    const frame = frames[k];
    const button = node("button", { class: frame.hit ? "hit" : frame.state, title: describe(frame) }, host);
    const thumb = node("div", { class: "thumb" }, button);
    crop(thumb, node("img", { src: frame.uri, alt: "" }, thumb), data.tiles[0]);
    node("span", {}, button, data.unit + " " + frame.n);
    button.addEventListener("click", () => { stop(); show(position); });
    buttons.push(button);
  });
  views.push({ draw() {}, mark: () => buttons.forEach((button, k) => button.setAttribute("aria-pressed", String(k === step))) });
}

// ---- the page ----

views.push(viewer());
if (data.stills) {
  if (pictured.length) gallery();
  table("pictures", () => steps[step], showFrame);
} else {
  views.push(strip());
  const time = "time (s)", small = () => 190;
  const over = (value) => frames.flatMap((frame, k) => (value(frame) === null ? [] : [[frame.t, value(frame), k]]));
  const hits = { kind: "hit", points: over((frame) => frame.hit && frame.hit.m) };
  chart("distances", { title: "Distance of the tracked obstacles over time", x: time, y: "distance (m)", low: 0, empty: "no obstacle was confirmed",
    height: (width) => Math.min(400, 200 + width / 5),
    series: [...tracks.map(({ id, points }) => ({ id, kind: "line", points: points.map(([k, m]) => [frames[k].t, m, k]) })), hits] });
  chart("map", { title: "Tracks and camera from above", x: data.axes[0] + " (m)", y: data.axes[1] + " (m)", equal: true, height: (width) => Math.min(460, width),
    series: [...tracks.map(({ id, points }) => ({ id, kind: "line", points: points.map(([k, , x, y]) => [x, y, k]) })),
      { kind: "path", points: frames.map((frame, k) => [...frame.camera, k]) }],
    spreads: tracks.map(({ id, spread: [a, b, angle], points }) => ({ id, a, b, angle, x: points.at(-1)[2], y: points.at(-1)[3] })) });
  chart("left", { title: "Time left to the nearest collision", x: time, y: "time left (s)", low: 0, height: small,
    series: [{ kind: "hit", points: over((frame) => frame.hit && frame.hit.s) }], empty: data.no_time_left });
  chart("valid", { title: "Share of pixels with a disparity over time", x: time, y: "valid (%)", low: 0, high: 100, height: small, series: [{ kind: "plain", points: over((frame) => frame.valid) }] });
  chart("seen", { title: "How far the flight path is seen over time", x: time, y: "seen up to (m)", low: 0, height: small, series: [{ kind: "plain", points: over((frame) => frame.seen) }] });
  table("tracks", () => selected, (id) => select(id === selected ? null : id));
}
stageChart();
for (const view of views) { view.draw(); view.mark(); }

document.addEventListener("keydown", (event) => {
  if (event.target.type === "range" || event.ctrlKey || event.metaKey || event.altKey) return;
  const go = { ArrowRight: step + 1, ArrowLeft: step - 1, Home: 0, End: steps.length - 1 }[event.key];
  if (go !== undefined) { stop(); show(go); event.preventDefault(); }
  if (event.key === "Escape") select(null);
  if (event.key === " " && event.target === document.body) { toggle(); event.preventDefault(); }
});
