// Puts the page together: the player, the panels, and what the keys and buttons do.

/** [s] A film takes about so long at its first speed. */
const FILM_SECONDS = 8;
const SPEEDS = [1, 2, 5, 10, 20, 30, 60];
/** [1/s] Swings of the mechanism. */
const SWING = 0.5;

class Player {
  constructor(view, onShow) {
    this.view = view;
    this.results = view.results;
    this.onShow = onShow;
    this.playing = false;
    this.speed = SPEEDS.find((speed) => speed >= this.results.states.length / FILM_SECONDS) || SPEEDS[SPEEDS.length - 1];
    const last = this.results.states.length - 1;
    byId("state").max = String(last);
    this.results.states.forEach((_, i) => element("option", { value: String(i), textContent: this.results.label(i) }, byId("state-name")));
    SPEEDS.forEach((speed) => element("option", { value: String(speed), textContent: `${speed} states/s` }, byId("speed")));
    byId("speed").value = String(this.speed);
    byId("state").addEventListener("input", (event) => this.go(Number(event.target.value)));
    byId("state-name").addEventListener("change", (event) => this.go(Number(event.target.value)));
    byId("speed").addEventListener("change", (event) => {
      this.speed = Number(event.target.value);
      this.restartClock();
    });
    byId("back").addEventListener("click", () => this.step(-1));
    byId("forward").addEventListener("click", () => this.step(1));
    byId("play").addEventListener("click", () => this.toggle());
    byId("amplitude").addEventListener("input", (event) => {
      this.stop();
      this.setAmplitude(Number(event.target.value));
    });
    this.go(last);
  }

  step(by) {
    this.stop();
    this.go(this.view.state + by);
  }

  go(state) {
    this.view.show(Math.min(this.results.states.length - 1, Math.max(0, state)));
    byId("state").value = byId("state-name").value = String(this.view.state);
    byId("amplitude-label").hidden = !this.view.isMechanism;
    byId("speed-label").hidden = this.view.isMechanism;
    this.onShow(this.playing);
  }

  /** Of the drawing at 0, of the mechanism as the program draws it at 1. */
  setAmplitude(amplitude) {
    this.view.amplitude = amplitude;
    byId("amplitude").value = String(amplitude);
    this.view.request();
  }

  toggle() {
    if (this.playing) return this.stop();
    if (!this.view.isMechanism && this.view.state === this.results.states.length - 1) this.go(0);
    this.playing = true;
    byId("play").textContent = "stop";
    this.restartClock();
    requestAnimationFrame((now) => this.frame(now));
  }

  restartClock() { this.begin = { time: performance.now(), state: this.view.state }; }

  stop() {
    this.playing = false;
    byId("play").textContent = "play";
    this.onShow(false);
  }

  /** By the clock: where a picture takes long, states are left out and the film keeps its pace. */
  frame(now) {
    if (!this.playing) return;
    const seconds = Math.max(0, now - this.begin.time) / 1000;
    if (this.view.isMechanism) {
      this.setAmplitude(1 - Math.cos(2 * Math.PI * SWING * seconds));
    } else {
      const state = this.begin.state + Math.floor(seconds * this.speed);
      if (state >= this.results.states.length - 1) {
        this.go(this.results.states.length - 1);
        return this.stop();
      }
      if (state !== this.view.state) this.go(state);
    }
    requestAnimationFrame((later) => this.frame(later));
  }
}

function byId(id) { return document.getElementById(id); }

function addTools(view) {
  const has = (key) => view.results.states.some((state) => state[key]);
  const colours = ["material", "displacement"];
  if (has("velocity_f4")) colours.push("velocity");
  if (has("contacts")) colours.push("contacts");
  colours.forEach((name) => element("option", { value: name, textContent: name === "contacts" ? "what touches" : name }, byId("colour")));
  byId("colour").addEventListener("change", (event) => {
    view.colour = event.target.value;
    view.request();
  });
  const layers = [["joints", true], ["forces", has("contacts")], ["openings", has("cracks")], ["velocities", has("velocity_f4")], ["symbols", view.results.data.symbols.length > 0]];
  for (const [name, isThere] of layers) {
    if (!isThere) continue;
    const label = element("label", {}, byId("layers")), box = element("input", { type: "checkbox", id: `layer-${name}`, checked: view.layers[name] }, label);
    label.append(` ${name}`);
    box.addEventListener("change", () => {
      view.layers[name] = box.checked;
      view.request();
    });
  }
  const mechanism = view.results.states.findIndex((state) => state.is_mechanism);
  if (mechanism >= 0) {
    view.colour = "velocity";
    view.layers.velocities = byId("layer-velocities").checked = true;
  }
  byId("colour").value = view.colour;
  byId("fit").addEventListener("click", () => fitState(view));
  byId("save").addEventListener("click", () => element("a", { href: view.canvas.toDataURL("image/png"), download: `${view.results.data.folder}.png` }).click());
  addSearch(view);
}

function fitState(view) { view.fit(movedVertices(view.results, view.motion, view.shownAmplitude, view.isMechanism, view.places)); }

function addSearch(view) {
  const find = byId("find");
  find.addEventListener("focus", () => {
    const list = byId("block-names");
    if (!list.children.length) view.results.names.slice(0, 5000).forEach((name) => element("option", { value: name }, list));
  });
  find.addEventListener("change", () => {
    const block = view.results.index.get(find.value.trim());
    find.classList.toggle("bad", block === undefined);
    if (block === undefined) return;
    [view.x, view.y] = view.centroidOf(block);
    view.select({ kind: "block", block });
  });
}

function addPictures(results, onPick) {
  const parent = byId("pictures"), charts = [], { data } = results;
  if (results.isFactor) {
    addDisplacementCurve(parent, results.summary);
    if (data.trials.length) addTrials(parent, data.trials, results.summary);
    if (data.curve) addMotionCurve(parent, data.curve);
    return charts;
  }
  if (data.history) charts.push(new CurvePanel(parent, { title: "Measured points", table: data.history, choices: HISTORY_CHOICES, onPick,
    note: "Displacements count from time 0, after settling." }).chart);
  if (data.energy) charts.push(addEnergy(parent, data.energy, onPick));
  if (data.contact_history) charts.push(new CurvePanel(parent, { title: "Measured contacts", table: data.contact_history, choices: CONTACT_CHOICES, onPick }).chart);
  if (data.milestones.length) addMilestones(parent, data.milestones);
  return charts;
}

function listenToKeys(player, view) {
  document.addEventListener("keydown", (event) => {
    if (["INPUT", "SELECT", "TEXTAREA"].includes(event.target.tagName) || event.ctrlKey || event.metaKey || event.altKey) return;
    const actions = {
      ArrowLeft: () => player.step(-1), ArrowRight: () => player.step(1), Home: () => player.go(0), End: () => player.go(view.results.states.length - 1),
      " ": () => player.toggle(), 0: () => fitState(view), Escape: () => view.select(null),
      "+": () => view.zoom(view.width / 2, view.height / 2, 1.25), "-": () => view.zoom(view.width / 2, view.height / 2, 0.8),
    };
    // A button that has the focus is pressed by the space bar itself.
    if (!actions[event.key] || (event.key === " " && event.target.tagName === "BUTTON")) return;
    event.preventDefault();
    actions[event.key]();
  });
}

function nearestState(results, time) {
  let nearest = 0, least = Infinity;
  results.states.forEach((state, i) => {
    if (state.time_s === undefined || Math.abs(state.time_s - time) >= least) return;
    least = Math.abs(state.time_s - time);
    nearest = i;
  });
  return nearest;
}

function fillHead(results) {
  const { data, summary } = results;
  const title = summary.title || data.folder;
  document.title = `${title} - Openclose`;
  byId("title").textContent = title;
  byId("answer").textContent = data.answer;
  const parts = [`${results.count} blocks`, data.folder];
  if (summary.command) parts.push(`openclose ${summary.command} ${summary.scene}`, ...(summary.overrides || []), `version ${summary.version}`);
  byId("about").textContent = parts.join(" \u00b7 ");
  byId("film-note").textContent = filmNote(results);
  byId("footer").textContent = "SI units, unit thickness; compression is positive in contact forces, a gap above 0 is open, rotation counter-clockwise.";
}

function filmNote(results) {
  const { states_left_out: leftOut, states_without_contacts: bare } = results.data, count = results.states.length;
  const notes = [];
  if (leftOut) notes.push(`${count} of ${count + leftOut} states are in this page`);
  if (bare) notes.push(`${bare} of ${count} states are without their contacts`);
  if (notes.length) return `${notes.join("; ")}, so that it does not become too large (report --most-mb).`;
  return count < 4 && !results.isFactor ? "For a film, write snapshots: output.snapshots_every_s." : "";
}

function main() {
  const results = new Results(JSON.parse(byId("data").textContent));
  byId("data").remove();
  fillHead(results);
  fillTrust(results, byId("trust-body"));
  const view = new View(results, byId("view"));
  addTools(view);
  const pick = (time) => {
    player.stop();
    player.go(nearestState(results, time));
  };
  const charts = addPictures(results, pick);
  const block = results.isFactor ? null : new BlockPanel(byId("pictures"), results, pick);
  const showTime = () => {
    const time = results.states[view.state].time_s;
    for (const chart of block ? [...charts, block.chart] : charts) {
      chart.cursor = time === undefined ? null : time;
      chart.draw();
    }
  };
  const player = new Player(view, (isPlaying) => {
    fillValues(view, byId("values-body"));
    if (!isPlaying) showTime();
  });
  view.onSelect = (selected) => {
    fillValues(view, byId("values-body"));
    if (block) block.fill(selected);
  };
  fillScene(results, byId("scene-body"));
  listenToKeys(player, view);
  window.openclose = { results, view, player };
}

main();
