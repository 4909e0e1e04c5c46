"use strict";
const $ = (id) => document.getElementById(id);
const HISTORY = 300, PLAN_M = 60, LOST_MS = 1000;
const history_ms = [];
let state = null, arrived_ms = 0, lastFrame = null, loading = false, whole = false, connected = false;

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const metres = (x) => (x === null ? "–" : `${x.toFixed(1)} m`);
const say = (id, text) => { if ($(id).textContent !== text) $(id).textContent = text; };
const NAMES = { too_near: "too near", ground: "ground", place: "in the way" }; // of what has no track
const numberOf = (obstacle) => NAMES[obstacle.kind] ?? `#${obstacle.id}`;

/** A canvas of as many pixels as it covers of the screen, cleared. */
function clean(id) {
  const canvas = $(id), box = canvas.getBoundingClientRect(), ratio = devicePixelRatio || 1;
  canvas.width = Math.round(box.width * ratio);
  canvas.height = Math.round(box.height * ratio);
  const paper = canvas.getContext("2d");
  paper.scale(ratio, ratio);
  paper.font = "12px system-ui, sans-serif";
  return [paper, box.width, box.height];
}

function banner() {
  const age_ms = state?.frame == null ? null : state.age_ms + performance.now() - arrived_ms;
  const show = (kind, text) => { $("banner").className = `note ${kind}`; say("banner", text); };
  if (!connected && state) return show("blind", "VISTA does not answer: the run has ended, or this page has lost it.");
  if (age_ms === null) return show("unknown", "Waiting for the first frame.");
  if (age_ms > LOST_MS) return show("blind", `No new frame for ${(age_ms / 1000).toFixed(1)} s: nothing below is of this moment.`);
  const { health, nearest_collision: nearest } = state.line;
  const why = state.reasons.length ? `: ${state.reasons.join("; ")}` : "";
  const left = nearest && nearest.time_to_collision_s !== null ? `, in ${nearest.time_to_collision_s.toFixed(1)} s` : "";
  const ahead = nearest ? `ollision ahead: ${metres(nearest.distance_m)}${left}` : "";
  if (health.state === "blind") return show("blind", `Blind${why}${nearest ? `. Carried on from before: c${ahead}` : ""}`);
  if (nearest) return show("hit", `C${ahead}${health.state === "healthy" ? "" : ` (${health.state}${why})`}`);
  if (health.state !== "healthy") return show(health.state, `${health.state[0].toUpperCase()}${health.state.slice(1)}${why}`);
  show("good", `Nothing is on the path, as far as it is seen: ${metres(state.line.path_seen_m)}`);
}

function figures() {
  say("rate", `${state.rate_hz.toFixed(1)} Hz`);
  say("counts", `${state.processed} frames, ${state.dropped} dropped, ${state.duplicates} duplicates`);
  say("latency", `${state.latency_ms.last.toFixed(0)} ms`);
  say("percentiles", `median ${state.latency_ms.median.toFixed(0)}, p99 ${state.latency_ms.p99.toFixed(0)} ms`);
  const link = state.autopilot;
  say("sent", link ? `${link.median_ms.toFixed(0)} ms` : "none");
  say("link", link ? `to the message; ${link.sent} sent to ${link.target}, ${link.lost} lost` : "start with --to to tell one");
  if (state.frame === null) return;
  const blind = state.line.health.state === "blind", nearest = blind ? null : state.line.nearest_collision;
  say("nearest", nearest ? metres(nearest.distance_m) : blind ? "–" : "none");
  say("nearest_at", blind ? "the view is blind" : nearest && nearest.time_to_collision_s !== null ? `in ${nearest.time_to_collision_s.toFixed(1)} s` : "\u00a0");
  say("path", metres(Math.min(state.line.path_seen_m, nearest?.distance_m ?? Infinity)));
  const turn = state.alignment, degrees = (x) => `${x < 0 ? "" : "+"}${x.toFixed(2)}°`;
  const aligned = turn ? `; right camera corrected by ${degrees(turn.pitch_deg)} in pitch, ${degrees(turn.roll_deg)} in roll` : "";
  say("frame", `frame ${state.frame}${aligned}`);
}

function table() {
  const rows = state.line.obstacles.slice(0, 12).map((o) => {
    const [x, y] = o.position_camera_m, row = document.createElement("tr");
    row.className = o.in_collision_volume ? "hit" : "";
    const cells = [numberOf(o), metres(o.distance_m), metres(x), metres(y), metres(o.extent_m[0]), metres(o.extent_m[1]), o.kind, o.coasting ? "not seen in this frame" : ""];
    for (const text of cells) row.appendChild(document.createElement("td")).textContent = text;
    return row;
  });
  $("obstacles").replaceChildren(...rows);
}

function plan() {
  const [paper, width, height] = clean("plan");
  const eye = [width / 2, height - 14], px = (height - 30) / PLAN_M;
  const at = (x_m, z_m) => [eye[0] + px * x_m, eye[1] - px * z_m];
  paper.save();
  const directions = state.line.directions;
  paper.fillStyle = colour("--good");
  paper.globalAlpha = 0.16;
  directions?.free_m.forEach((free_m, k) => {
    const from = ((directions.first_deg + k - 90) * Math.PI) / 180;
    paper.beginPath();
    paper.moveTo(...eye);
    paper.arc(...eye, px * Math.min(free_m, PLAN_M), from, from + Math.PI / 180);
    paper.fill();
  });
  paper.restore();
  paper.strokeStyle = colour("--line");
  paper.fillStyle = colour("--soft");
  for (let m = 10; m <= PLAN_M; m += 10) {
    paper.beginPath();
    paper.arc(...eye, px * m, Math.PI, 2 * Math.PI);
    paper.stroke();
    if (m % 20 === 0) paper.fillText(`${m} m`, eye[0] + 3, eye[1] - px * m + 12);
  }
  const v = state.line.velocity_camera_m_s;
  if (v && Math.hypot(v[0], v[2]) > 0.5) {
    const scale = PLAN_M / Math.hypot(v[0], v[2]);
    paper.strokeStyle = colour("--ink");
    paper.setLineDash([4, 4]);
    paper.beginPath();
    paper.moveTo(...eye);
    paper.lineTo(...at(v[0] * scale, v[2] * scale));
    paper.stroke();
    paper.setLineDash([]);
  }
  for (const o of [...state.line.obstacles].reverse()) {
    const [x, , z] = o.position_camera_m;
    if (x === null || z === null || z > PLAN_M) continue;
    const [u, w] = at(x, z);
    paper.fillStyle = paper.strokeStyle = colour(o.in_collision_volume ? "--warning" : "--degraded");
    paper.lineWidth = 3;
    paper.beginPath();
    paper.moveTo(u - (px * o.extent_m[0]) / 2, w);
    paper.lineTo(u + (px * o.extent_m[0]) / 2, w);
    paper.stroke();
    paper.lineWidth = 1;
    paper.beginPath();
    paper.arc(u, w, 4, 0, 2 * Math.PI);
    paper.fill();
    const away = Math.hypot(x, z) || 1, sigma = sigmaAlong(o, away);
    paper.beginPath();
    paper.moveTo(...at(x - (x / away) * sigma, z - (z / away) * sigma));
    paper.lineTo(...at(x + (x / away) * sigma, z + (z / away) * sigma));
    paper.stroke();
    paper.fillText(numberOf(o), u + 6, w - 6);
  }
}

/** One sigma of the distance, in metres: the largest of the position's, which lies along the line of sight. */
function sigmaAlong(o, away_m) {
  const trace = o.covariance_m2.reduce((sum, row, k) => sum + (row[k] ?? 0), 0);
  return Math.min(Math.sqrt(trace), away_m);
}

function history() {
  const [paper, width, height] = clean("history");
  const most = Math.max(50, ...history_ms) * 1.1, y = (ms) => height - 4 - ((height - 8) * ms) / most;
  const step = most > 500 ? 200 : most > 150 ? 50 : 20;
  paper.strokeStyle = colour("--line");
  paper.fillStyle = colour("--soft");
  for (let ms = 0; ms < most; ms += step) {
    paper.beginPath();
    paper.moveTo(0, y(ms));
    paper.lineTo(width, y(ms));
    paper.stroke();
    paper.fillText(`${ms} ms`, 2, y(ms) - 2);
  }
  paper.strokeStyle = colour("--accent");
  paper.beginPath();
  history_ms.forEach((ms, k) => paper.lineTo(50 + ((width - 54) * k) / (HISTORY - 1), y(ms)));
  paper.stroke();
}

/** One picture at a time: the next is asked for when this one is there. */
function picture() {
  if (loading || state?.frame == null) return;
  loading = true;
  const next = new Image();
  next.onload = () => { $("picture").src = next.src; loading = false; };
  next.onerror = () => { loading = false; };
  next.src = `/picture.jpg?${whole ? "whole" : "left"}&${performance.now()}`;
}

function show() {
  figures();
  if (state.frame !== null && state.age_ms !== undefined && state.frame !== lastFrame) {
    lastFrame = state.frame;
    history_ms.push(state.latency_ms.last);
    if (history_ms.length > HISTORY) history_ms.shift();
    table();
    plan();
    history();
    picture();
  }
  banner();
}

const states = new EventSource("/states");
states.onopen = () => { connected = true; };
states.onmessage = (event) => { state = JSON.parse(event.data); arrived_ms = performance.now(); connected = true; show(); };
states.onerror = () => { connected = false; banner(); };
setInterval(banner, 250);
$("whole").onclick = () => {
  whole = !whole;
  $("whole").setAttribute("aria-pressed", whole);
  picture();
};
