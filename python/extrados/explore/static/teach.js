// The lessons of a panel: one is begun, predicted, tried and checked.
import { h } from "./dom.js";
import { LESSONS } from "./lessons.js";
import { tr } from "./words.js";

export function teachPanel(app, box) {
  const list = h("ol", { class: "exercises" });
  const text = h("div", { class: "exercise", "aria-live": "polite" });
  box.append(h("p", {}, tr`Ten lessons of five minutes: predict, try, check, and read who first asked the question.`), list, text);
  const done = new Set(JSON.parse(read("extrados-lessons") ?? "[]"));
  let current = null;
  function read(key) { try { return localStorage.getItem(key); } catch { return null; } }
  function items() {
    list.replaceChildren(...LESSONS.map((x, k) => h("li", {}, h("button", { "aria-current": current === k ? "true" : null, onclick: () => begin(k) }, x.title, done.has(k) ? h("span", { class: "tick", role: "img", "aria-label": "done" }, " ✓") : null))));
  }
  function begin(k) {
    current = k;
    const x = LESSONS[k];
    app.open({ text: x.deck, name: `lesson-${k + 1}.toml` });
    app.setTab(x.tab);
    const history = h("p", { class: "history" });
    let predicted = null;
    const choices = h("fieldset", {}, h("legend", {}, tr`What do you expect?`), x.choices.map((text, n) => h("label", {}, h("input", { type: "radio", name: "prediction", onchange: () => { predicted = n; checks.disabled = false; } }), ` ${text}`)));
    const told = h("p", { class: "told", role: "status" });
    const say = (good, words) => {
      told.className = `told ${good ? "good" : "bad"}`;
      told.textContent = words;
      if (!good) return;
      history.replaceChildren(h("b", {}, predicted === x.right ? tr`Your prediction was right. ` : tr`Your prediction was wrong. The right answer: ${x.choices[x.right]}. `.replace("..", ".")), x.history);
      done.add(k);
      try { localStorage.setItem("extrados-lessons", JSON.stringify([...done])); } catch { /* a browser without storage */ }
      items();
    };
    const check = () => {
      if (!app.scene || app.scene.empty) return;
      const found = x.check(app);
      if (found[0] === "ask") x.verify(app, found[1], say); else say(...found);
    };
    const checks = h("button", { class: "first", disabled: true, onclick: check }, tr`Check`);
    text.replaceChildren(h("h3", {}, x.title), h("p", {}, x.task), h("p", { class: "question" }, x.question), choices, h("div", { class: "row" }, checks, h("button", { onclick: () => begin(k) }, tr`Begin again`)), told, history);
    items();
  }
  items();
}
