// The collapse of a structure that cannot stand, or is tilted beyond its capacity: shown in real time, then slower.
import { capital, h } from "./dom.js";
import { said } from "./said.js";
import { tr } from "./words.js";

const LAST = 1.0; // s for which the last picture stays before the replay
const SLOW = 0.5;

/** Poses (blocks x 3) of a film `pose` (pictures, blocks, 3) at its `time`, at any time between two pictures. */
export function poseAt(time, pose, t) {
  const n = pose.shape[1] * 3;
  let k = 0;
  while (k + 2 < time.length && time[k + 1] <= t) k += 1;
  const next = Math.min(k + 1, time.length - 1), width = time[next] - time[k];
  const share = width > 0 ? Math.min(1, Math.max(0, (t - time[k]) / width)) : 0;
  return Float32Array.from({ length: n }, (_, i) => pose[k * n + i] + share * (pose[next * n + i] - pose[k * n + i]));
}

export function fallPanel(app, frame) {
  const it = { time: [], pose: null, now: 0, done: false, playing: null, failed: "" };
  app.fall = it;
  const why = h("p", { class: "why" });
  const button = (label, act) => h("button", { onclick: act }, label);
  const again = button(tr`▶ Replay`, () => play(1)), slow = button(tr`Half speed`, () => play(SLOW)), back = button(tr`Show the structure`, stop);
  const box = h("div", { class: "fall", role: "status", hidden: true }, why, h("div", { class: "row" }, again, slow, back));
  frame.querySelector(".stage-box").before(box);
  const still = matchMedia("(prefers-reduced-motion: reduce)");

  app.on("scene", () => { stop(); it.time = []; it.pose = null; it.done = false; it.failed = ""; box.hidden = true; });
  app.on("tab", (name) => { if (name !== "structure") stop(); box.hidden = true; });
  app.on("detail", () => {
    if (!app.scene?.falls || app.tab !== "structure") return;
    box.hidden = false;
    tell();
    if (!it.time.length && !app.drawing.held()) app.ask({ do: "fall", lane: "fall" });
  });
  app.on("complaint", (words, message) => { if (message?.do === "fall") { it.failed = (words.complaints ?? [words.bad]).join(" "); tell(); } });
  app.on("fall", (words, { fall_time: time, fall_pose: pose }) => {
    if (!app.scene?.falls || app.tab !== "structure") return;
    if (words.first) { it.time = []; it.pose = null; }
    if (pose.length) {
      const joined = new Float32Array((it.pose?.length ?? 0) + pose.length);
      if (it.pose) joined.set(it.pose);
      joined.set(pose, it.pose?.length ?? 0);
      joined.shape = [it.time.length + time.length, pose.shape[1], 3];
      it.pose = joined;
      it.time = [...it.time, ...time];
    }
    it.done = words.done;
    it.failed = words.stopped ? tr`The computation ended at ${(it.time.at(-1) ?? 0).toFixed(1)} s: ${words.stopped}.` : "";
    tell();
    if (words.first && !still.matches) play(1, true);
  });

  function tell() {
    const { scene } = app;
    const told = said(scene.why ?? app.detail?.why ?? "");
    why.title = told;
    why.replaceChildren(h("b", {}, scene.falls === "weight" ? tr`Cannot stand. ` : tr`Collapses towards ${scene.falls === "plus" ? "+x" : "−x"}. `), it.failed || capital(told.split("; certificate")[0]));
    again.disabled = slow.disabled = !it.time.length;
    back.hidden = !app.drawing.moving();
  }
  /** Play the fall at a speed; once: it is shown again, slower, when it has ended. */
  function play(speed, once = false) {
    if (!it.time.length) return;
    app.stopMechanism();
    cancelAnimationFrame(it.playing);
    it.now = 0;
    let last = performance.now(), rest = LAST;
    const step = (time) => {
      const passed = (time - last) / 1000, end = it.time.at(-1);
      last = time;
      it.now = Math.min(it.now + speed * passed, end);
      seek(it.now);
      if (it.now >= end && it.done) {
        rest -= passed;
        if (!once && rest < LAST) { it.playing = null; return; }
        if (rest <= 0) { play(SLOW); return; }
      }
      it.playing = requestAnimationFrame(step);
    };
    it.playing = requestAnimationFrame(step);
  }
  /** Show the blocks at a time of the fall [s]. */
  function seek(time) {
    const was = app.drawing.moving();
    app.drawing.pose(poseAt(it.time, it.pose, time), { falling: true });
    if (!was) tell();
  }
  function stop() {
    cancelAnimationFrame(it.playing);
    it.playing = null;
    if (app.drawing.moving() && it.time.length) { app.drawing.pose(null); if (app.scene) tell(); }
  }
  Object.assign(it, { play, seek, stop });
}
