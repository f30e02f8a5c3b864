// The values of what was clicked, the curves below the player, and the scene.

/** Places in the coordinates of a survey lie a million metres from its origin. */
const PLACE_DIGITS = 10;

/** Columns of a curve, unpacked. */
function columnsOf(table, curve) {
  const columns = {};
  for (const name of table.columns) columns[name] = unpack.f4(curve[`${name}_f4`]);
  return columns;
}

function addRow(table, what, value, unit, key) {
  const row = element("tr", {}, table);
  row.dataset.key = key || what;
  element("th", { textContent: what }, row);
  element("td", { textContent: value, className: "number" }, row);
  element("td", { textContent: unit || "", className: "unit" }, row);
}

function fillValues(view, parent) {
  parent.replaceChildren();
  if (!view.selected) {
    element("p", { className: "note", textContent: "Click on a block or a contact. The wheel zooms, dragging moves, arrow keys step through the states, space plays." }, parent);
    return;
  }
  const table = element("table", { id: "values-table" }, parent);
  if (view.selected.kind === "block") blockRows(view, table, view.selected.block);
  else contactRows(view, table, view.selected.contact);
}

function blockRows(view, table, b) {
  const { results } = view, motion = view.motion, velocity = results.velocity(view.state), [ox, oy] = results.data.origin;
  addRow(table, "block", results.names[b], "", "block");
  addRow(table, "material", results.materials[results.material[b]] + (results.fixed[b] ? ", fixed" : ""), "", "material");
  addRow(table, "area", number(results.area[b]), "m\u00b2", "area_m2");
  addRow(table, "mass", number(results.mass[b]), "kg/m", "mass_kg");
  if (view.isMechanism) {
    addRow(table, "in the mechanism", "the fastest point has 1", "", "scale");
    addRow(table, "velocity x", number(velocity[3 * b]), "-", "velocity_x");
    addRow(table, "velocity y", number(velocity[3 * b + 1]), "-", "velocity_y");
    addRow(table, "rotation", number(velocity[3 * b + 2]), "1/m", "rotation_per_m");
    return;
  }
  const names = ["x", "y"], origin = [ox, oy];
  for (const k of [0, 1]) addRow(table, `centroid ${names[k]}`, number(origin[k] + results.centroids[2 * b + k] + motion[3 * b + k], PLACE_DIGITS), "m", `${names[k]}_m`);
  for (const k of [0, 1]) addRow(table, `displacement ${names[k]}`, number(motion[3 * b + k]), "m", `displacement_${names[k]}_m`);
  addRow(table, "displacement", number(Math.hypot(motion[3 * b], motion[3 * b + 1])), "m", "displacement_m");
  addRow(table, "rotation", number(motion[3 * b + 2]), "rad", "rotation_rad");
  if (!velocity) return;
  for (const k of [0, 1]) addRow(table, `velocity ${names[k]}`, number(velocity[3 * b + k]), "m/s", `velocity_${names[k]}_m_per_s`);
  addRow(table, "angular velocity", number(velocity[3 * b + 2]), "rad/s", "angular_velocity_rad_per_s");
}

function contactRows(view, table, k) {
  const { results } = view, c = results.contact(view.state, k), [ox, oy] = results.data.origin;
  addRow(table, "contact", `corner of ${results.names[c.a]} on ${results.names[c.b]}`, "", "contact");
  addRow(table, "status", STATUS[c.status], "", "status");
  addRow(table, "normal force", number(c.normalForce), "N/m", "normal_force_n");
  addRow(table, "shear force", number(c.shearForce), "N/m", "shear_force_n");
  if (c.normalForce > 0) addRow(table, "inclination of the force", number((Math.atan2(Math.abs(c.shearForce), c.normalForce) * 180) / Math.PI, 4), "\u00b0 from the normal", "inclination_deg");
  addRow(table, "gap (open above 0)", number(c.gap), "m", "gap_m");
  addRow(table, "tributary length", number(c.length), "m", "length_m");
  addRow(table, "x", number(ox + c.x, PLACE_DIGITS), "m", "x_m");
  addRow(table, "y", number(oy + c.y, PLACE_DIGITS), "m", "y_m");
}

/** A picture of curves with a choice of what they show. */
class CurvePanel {
  constructor(parent, { title, table, choices, note, onPick }) {
    this.table = table;
    this.choices = choices;
    this.chart = new Chart(parent, { title, xLabel: "time [s]", yLabel: "", note: [note, thinned(table)].filter(Boolean).join(" "), onPick });
    this.select = element("select", {}, this.chart.bar);
    choices.forEach(({ text }, i) => element("option", { value: String(i), textContent: text }, this.select));
    this.select.addEventListener("change", () => this.fill());
    this.fill();
  }

  fill() {
    const { text, of } = this.choices[Number(this.select.value)];
    this.chart.set(this.table.curves.map((curve) => {
      const columns = columnsOf(this.table, curve);
      return { name: curve.name, x: columns.time_s, y: of(columns) };
    }), { yLabel: text });
  }
}

function thinned(table) {
  const notes = [];
  if (table.every > 1) notes.push(`Every ${table.every}th row of the table.`);
  if (table.curves.length < table.curves_in_table) notes.push(`${table.curves.length} of ${table.curves_in_table}, those that reach farthest.`);
  return notes.join(" ");
}

const HISTORY_CHOICES = [
  { text: "displacement [m]", of: (c) => c.displacement_x_m.map((x, i) => Math.hypot(x, c.displacement_y_m[i])) },
  { text: "displacement x [m]", of: (c) => c.displacement_x_m },
  { text: "displacement y [m]", of: (c) => c.displacement_y_m },
  { text: "rotation [rad]", of: (c) => c.rotation_rad },
  { text: "velocity [m/s]", of: (c) => c.velocity_x_m_per_s.map((x, i) => Math.hypot(x, c.velocity_y_m_per_s[i])) },
  { text: "angular velocity [rad/s]", of: (c) => c.angular_velocity_rad_per_s },
];
const CONTACT_CHOICES = [
  { text: "normal force [N/m]", of: (c) => c.normal_force_n },
  { text: "shear force [N/m]", of: (c) => c.shear_force_n },
  { text: "gap [m]", of: (c) => c.gap_m },
  { text: "slip [m]", of: (c) => c.slip_m },
];

function addEnergy(parent, table, onPick) {
  const chart = new Chart(parent, { title: "Energy ledger", xLabel: "time [s]", yLabel: "since time 0 [J]", onPick,
    note: ["The sum of all entries is the imbalance: 0 but for rounding.", thinned(table)].filter(Boolean).join(" ") });
  const columns = columnsOf(table, table.curves[0]);
  const entries = table.columns.filter((name) => name !== "time_s" && name !== "turnover_j");
  chart.set(entries.filter((name) => name === "imbalance_j" || columns[name].some((value) => value !== 0))
    .map((name) => ({ name: name.replace(/_j$/, "").replaceAll("_", " "), x: columns.time_s, y: columns[name] })));
  return chart;
}

/** What was searched: the factor of a strength reduction, or the multiplier of a load. */
const factorOf = (row) => row.srf ?? row.multiplier;
const factorName = (summary) => (summary.options?.strength_reduction?.increase ? `multiplier of ${summary.options.strength_reduction.increase}` : "strength reduction factor");

/** Stable, failed and undecided trials in their order. */
function addTrials(parent, trials, summary) {
  const chart = new Chart(parent, { title: "Trials", xLabel: "trial", yLabel: factorName(summary) });
  const kinds = [["stable", 1, "dot", "#1a7a3a"], ["failed", 0, "cross", "#b91c1c"], ["undecided", "undecided", "ring", "#b45309"]];
  const all = { name: "", x: trials.map((_, i) => i + 1), y: trials.map(factorOf), colour: "#ccc" };
  const series = kinds.map(([name, value, marks, colour]) => {
    const chosen = trials.map((trial, i) => [i + 1, factorOf(trial), trial.stable]).filter((trial) => trial[2] === value);
    return { name, marks, colour, line: false, x: chosen.map((t) => t[0]), y: chosen.map((t) => t[1]) };
  });
  chart.set([all, ...series.filter((curve) => curve.x.length)]);
  const box = element("div", { className: "scroll" }, chart.box), table = element("table", { id: "trials-table" }, box), head = element("tr", {}, table);
  for (const name of [trials[0].srf === undefined ? "multiplier" : "factor", "outcome", "stage", "criterion", "steps", "displacement [m]"]) element("th", { textContent: name }, head);
  for (const trial of trials) {
    const row = element("tr", {}, table), outcome = trial.stable === 1 ? "stable" : trial.stable === 0 ? "failed" : "undecided";
    for (const text of [number(factorOf(trial), 8), outcome, trial.stage, trial.criterion, trial.steps, number(trial.displacement_m)]) element("td", { textContent: text, className: "number" }, row);
  }
}

function addDisplacementCurve(parent, summary) {
  const points = [...(summary.displacement_curve || [])].sort((a, b) => factorOf(a) - factorOf(b));
  if (points.length < 2) return;
  const chart = new Chart(parent, { title: "Displacement of stable trials", xLabel: factorName(summary), yLabel: "largest displacement [m]",
    note: "Largest displacement of a measured point, or of a block where none is measured, since the first stable state." });
  const lines = [];
  if (summary.bracket.stable !== null) lines.push({ x: summary.bracket.stable, text: `stable ${number(summary.bracket.stable)}`, colour: "#1a7a3a" });
  if (summary.bracket.failed !== null) lines.push({ x: summary.bracket.failed, text: `failed ${number(summary.bracket.failed)}`, colour: "#b91c1c" });
  if (summary.limit_analysis && summary.limit_analysis.factor) lines.push({ x: summary.limit_analysis.factor, text: `limit analysis ${number(summary.limit_analysis.factor)}`, colour: "#8e2b8e" });
  chart.set([{ name: "", marks: "dot", x: points.map(factorOf), y: points.map((p) => p.displacement_m) }], { lines });
}

function addMotionCurve(parent, table) {
  const chart = new Chart(parent, { title: "Displacement after a time of motion", xLabel: "strength reduction factor", yLabel: "displacement [m]" });
  chart.set(table.curves.map((curve) => {
    const columns = columnsOf(table, curve), order = [...columns.srf.keys()].sort((a, b) => columns.srf[a] - columns.srf[b]);
    return { name: curve.name, marks: "dot", x: order.map((i) => columns.srf[i]), y: order.map((i) => columns.displacement_m[i]) };
  }));
}

function addMilestones(parent, milestones) {
  const box = element("div", { className: "picture" }, parent);
  element("h2", { textContent: "Milestones" }, box);
  const table = element("table", {}, box), head = element("tr", {}, table);
  for (const name of ["displacement [m]", "time [s]", "CPU [s]", ""]) element("th", { textContent: name }, head);
  for (const m of milestones) {
    const row = element("tr", {}, table);
    for (const text of [number(m.displacement_m), m.time_s === null ? "not reached" : number(m.time_s), m.cpu_s === null ? "" : number(m.cpu_s, 3), m.reason || ""]) element("td", { textContent: text }, row);
  }
}

/** What a block does from state to state; empty until one is clicked. */
class BlockPanel {
  constructor(parent, results, onPick) {
    this.results = results;
    this.chart = new Chart(parent, { title: "The chosen block through the states", xLabel: "time [s]", yLabel: "[m], [rad]", onPick });
    this.chart.box.hidden = true;
    this.chart.box.id = "block-panel";
  }

  fill(selected) {
    this.chart.box.hidden = !selected || selected.kind !== "block";
    if (this.chart.box.hidden) return;
    const { results } = this, b = selected.block, times = [], values = [[], [], []];
    results.states.forEach((state, i) => {
      if (state.time_s === undefined) return;
      times.push(state.time_s);
      const motion = unpack.f4(state.motion_f4);
      values.forEach((list, k) => list.push(motion[3 * b + k]));
    });
    const names = ["displacement x [m]", "displacement y [m]", "rotation [rad]"];
    this.chart.bar.firstChild.textContent = `Block ${results.names[b]} through the states`;
    this.chart.set(values.map((y, k) => ({ name: names[k], x: times, y, marks: times.length < 60 ? "dot" : undefined })));
  }
}

function fillScene(results, parent) {
  const { summary, scene } = results.data;
  if (summary.options) {
    const box = element("details", {}, parent);
    element("summary", { textContent: "Every key with its value" }, box);
    const rows = [];
    for (const [table, keys] of Object.entries(summary.options)) {
      for (const [key, value] of Object.entries(keys && typeof keys === "object" ? keys : { "": keys })) rows.push([key ? `${table}.${key}` : table, value === null ? "-" : JSON.stringify(value)]);
    }
    addTable(box, rows, "options-table");
  }
  if (!scene) return;
  const box = element("details", {}, parent);
  element("summary", { textContent: "scene_as_read.toml" + (scene.blocks_left_out ? ` without its ${scene.blocks_left_out} blocks` : "") }, box);
  element("pre", { textContent: scene.text }, box);
}
