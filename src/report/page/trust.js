// What the answer rests on, in the order in which a reader should look at it.

const VERDICTS = {
  certified: ["good", "Both ends are proved: below, forces that balance inside the strength of the joints; above, a mechanism or a limit analysis."],
  interval: ["poor", "The bracket is wider than was asked for, or has no proved failure: the answer lies in it, and no better is known."],
  no_failure: ["poor", "No failure was found up to the limit of the search (strength_reduction.upper_limit)."],
  no_equilibrium: ["bad", "The blocks do not stand where the search begins: at no strength that was tried, or without the load that is to grow."],
  undecided: ["bad", "No stable state could be proved."],
};

function trustOfFactor(summary) {
  const { bracket, verdict, limit_analysis: limit, failing_blocks: failing } = summary;
  const [quality, sentence] = VERDICTS[verdict] || ["poor", ""];
  const rows = [["verdict", verdict, quality]];
  rows.push(["stable up to", bracket.stable === null ? "not proved" : number(bracket.stable), bracket.stable === null ? "bad" : ""]);
  rows.push(["failed at", bracket.failed === null ? "not proved" : `${number(bracket.failed)} by ${bracket.failed_by}`, bracket.failed === null ? "poor" : ""]);
  if (bracket.stable !== null && bracket.failed !== null) rows.push(["width of the bracket", number(bracket.failed - bracket.stable, 3)]);
  rows.push(["undecided trials", String(bracket.undecided_trials), bracket.undecided_trials ? "poor" : "good"]);
  if (limit) {
    const factor = limit.factor;
    const apart = factor && bracket.stable ? `, ${number((100 * (factor - bracket.stable)) / bracket.stable, 3)} % above` : "";
    rows.push(["rigid-block limit analysis", factor === null ? limit.verdict : `at most ${number(factor)}${apart}`, factor === null ? "poor" : ""]);
  }
  for (const effect of summary.shear_to_normal_stiffness || [])
    rows.push([`with shear/normal stiffness ${number(effect.ratio, 3)}`, effect.stable === null ? "not found"
      : effect.failed === null ? `not known, undecided above ${number(effect.stable, 4)}`
      : `${number(effect.stable, 4)} to ${number(effect.failed, 4)}`]);
  if (summary.largest_travel_m) rows.push(["farthest motion between two stable trials", lengthText(summary.largest_travel_m)]);
  if (failing && failing.number) rows.push(["what fails", `${failing.number} of ${summary.free_blocks} free blocks, ${number(failing.area_m2, 4)} m\u00b2${bracket.failed_by === "limit analysis" ? ", in the mechanism of the limit analysis" : ""}`]);
  pushGravity(rows, summary);
  rows.push(["definition", String(summary.definition).replaceAll("_", " ")]);
  return { rows, sentence };
}

/** Where it does not point straight down, factors and motions have it in them. */
function pushGravity(rows, summary) {
  if (summary.gravity_in_words) rows.push(["gravity", summary.gravity_in_words]);
}

function trustOfRun(summary, bounds) {
  const rows = [["ended", summary.converged ? `by ${summary.ended_by}` : "stopped", summary.converged ? "good" : "bad"]];
  const settling = summary.settling;
  if (settling) {
    rows.push(["start", settling.settled ? `settled in ${settling.steps} steps` : "did not settle", settling.settled ? "good" : "bad"]);
    if (settling.unbalanced_fraction !== undefined) rows.push(["unbalanced force / largest weight", number(settling.unbalanced_fraction, 3)]);
  }
  const watch = summary.watch;
  const checked = (what, value, bound) => rows.push([what, `${number(value, 3)} (refused above ${number(bound)})`, value <= bound ? "good" : "bad"]);
  if (watch) {
    rows.push(["checks", String(watch.checks)]);
    checked("created energy", watch.created_energy, bounds.created_energy);
    checked("closure / block width", watch.penetration, bounds.penetration);
    checked("overlap / block width", watch.overlap, bounds.penetration);
    checked("energy of a block / energy there was", watch.reach, bounds.reach);
  }
  const ledger = summary.energy_ledger;
  if (ledger) rows.push(["energy imbalance", `${number(ledger.imbalance_j, 3)} J of ${number(ledger.turnover_j, 3)} J moved`]);
  pushGravity(rows, summary);
  rows.push(["deepest penetration", lengthText(summary.max_penetration_m)]);
  return { rows, sentence: summary.converged ? "" : summary.reason };
}

function fillTrust(results, parent) {
  const { summary } = results;
  if (!summary.command) {
    element("p", { className: "poor", textContent: "The run has not ended: summary.json is missing. What it has written so far is shown." }, parent);
    return;
  }
  const { rows, sentence } = results.isFactor ? trustOfFactor(summary) : trustOfRun(summary, results.data.bounds);
  if (sentence) element("p", { textContent: sentence }, parent);
  addTable(parent, rows, "trust-table");
  const warnings = summary.warnings || [];
  if (warnings.length) {
    element("p", { textContent: warnings.length === 1 ? "One warning:" : `${warnings.length} warnings:` }, parent).style.margin = "10px 0 0";
    const list = element("ul", { className: "warnings", id: "warnings" }, parent);
    for (const warning of warnings) element("li", { textContent: warning }, list);
  } else {
    element("p", { className: "good", textContent: "No warnings." }, parent);
  }
}
