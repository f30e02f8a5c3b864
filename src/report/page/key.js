// Colours, arrows, and what stands on the picture besides the blocks: supports, loads and measured points, and the key below with the scale bar.

/** [px] Between the arrows of a load that is spread along an edge, about; and no more of them, however close one looks. */
const ARROW_SPACING = 22, MOST_LOAD_ARROWS = 60;

function write(context, text, x, y, colour = "#222") {
  context.lineWidth = 3;
  context.strokeStyle = "white";
  context.lineJoin = "round";
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
}

/** Of a named joint: names beyond the colours are dashed, ever shorter. */
function dashesOf(joint, colours) {
  const round = Math.floor(joint / colours.length);
  return round === 0 ? [] : [8 / round, 8 / round];
}

function gradientColour(gradient, part) {
  const place = Math.min(1, Math.max(0, part)) * (gradient.length - 1), i = Math.min(Math.floor(place), gradient.length - 2), share = place - i;
  return `rgb(${gradient[i].map((c, k) => Math.round((1 - share) * c + share * gradient[i + 1][k])).join(",")})`;
}

function drawArrow(context, x1, y1, x2, y2, colour, width, head) {
  const length = Math.hypot(x2 - x1, y2 - y1);
  if (length < 0.5) return;
  const ux = (x2 - x1) / length, uy = (y2 - y1) / length, size = Math.min(head, 0.6 * length), nx = x2 - size * ux, ny = y2 - size * uy;
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = width;
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(nx, ny);
  context.stroke();
  context.beginPath();
  context.moveTo(x2, y2);
  context.lineTo(nx - 0.4 * size * uy, ny + 0.4 * size * ux);
  context.lineTo(nx + 0.4 * size * uy, ny - 0.4 * size * ux);
  context.fill();
}

function drawSymbols(view) {
  const { context, results } = view, { symbols, colours } = results.data;
  const loads = symbols.filter((symbol) => symbol.kind === "load"), labels = labelsOf(loads);
  const largestOf = (spread) => Math.max(0, ...loads.filter((load) => isSpread(load) === spread).map(sizeOfLoad)), largest = largestOf(false), largestTraction = largestOf(true);
  const labelled = symbols.length <= MOST_LABELS;
  context.font = "13px system-ui, sans-serif";
  for (const symbol of symbols) {
    const place = (point) => view.toScreen(...carriedPoint(results, view.motion, view.shownAmplitude, view.isMechanism, symbol.block, point));
    const [x, y] = place(symbol.point);
    if (symbol.kind === "load") drawLoad(view, symbol, place, isSpread(symbol) ? largestTraction : largest, labels.get(symbol));
    if (symbol.kind === "support") drawSupport(context, symbol, x, y, colours.support);
    if (symbol.kind === "point") {
      context.beginPath();
      context.arc(x, y, 4, 0, 2 * Math.PI);
      context.fillStyle = "white";
      context.fill();
      context.strokeStyle = "black";
      context.lineWidth = 1.4;
      context.stroke();
      if (labelled) write(context, symbol.name, x + 7, y - 6);
    }
  }
}

/** [N], or [Pa] of a load that is spread. */
const sizeOfLoad = (load) => Math.hypot(...load.force) / (isSpread(load) ? Math.hypot(...load.spread) : 1);
const isSpread = (load) => Math.hypot(...load.spread) > 0;
/** A traction away from its block, which lies on the left of the stretch. */
const pullsAway = (load) => isSpread(load) && load.spread[0] * load.force[1] - load.spread[1] * load.force[0] < 0;

/** The heads are where the load acts: at a point, or at several of the stretch along which it is spread. What pulls has its tails there. */
function drawLoad(view, load, place, largest, label) {
  const { context } = view, colour = view.results.data.colours.load, size = sizeOfLoad(load);
  if (size === 0) return;
  const turn = load.turns ? view.shownAmplitude * view.motion[3 * load.block + 2] : 0, c = Math.cos(turn), s = Math.sin(turn), whole = Math.hypot(...load.force);
  const spread = isSpread(load), length = spread ? Math.max(14, (45 * size) / largest) : Math.max(18, (70 * size) / largest);
  const wayX = (length * (c * load.force[0] - s * load.force[1])) / whole, wayY = (-length * (s * load.force[0] + c * load.force[1])) / whole;
  const sign = pullsAway(load) ? 1 : -1, outer = ([x, y]) => [x + sign * wayX, y + sign * wayY];
  const along = (part) => place([load.point[0] + part * load.spread[0], load.point[1] + part * load.spread[1]]);
  if (spread) {
    const from = along(-0.5), to = along(0.5), reach = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const gaps = Math.max(1, Math.min(MOST_LOAD_ARROWS, Math.floor(reach / ARROW_SPACING)));
    for (let i = 0; i <= gaps; ++i) {
      const foot = along(i / gaps - 0.5), end = outer(foot);
      drawArrow(context, ...(sign > 0 ? foot : end), ...(sign > 0 ? end : foot), colour, 1.6, 8);
    }
    context.lineWidth = 1.6;
    context.beginPath();
    context.moveTo(...outer(from));
    context.lineTo(...outer(to));
    context.stroke();
  } else drawArrow(context, ...outer(along(0)), ...along(0), colour, 2.4, 11);
  const [x, y] = outer(along(0));
  if (label) write(context, label, x + 6, y - 4, colour);
}

/** What is written at each load: nothing where there are too many of them, and of several stretches with the same number only at the longest. */
function labelsOf(loads) {
  const labels = new Map(), longest = new Map();
  for (const load of loads) {
    if (!isSpread(load)) {
      if (loads.length <= MOST_LABELS) labels.set(load, forceText(sizeOfLoad(load)));
      continue;
    }
    const text = pressureText(sizeOfLoad(load)), other = longest.get(text);
    if (!other || Math.hypot(...other.spread) < Math.hypot(...load.spread)) longest.set(text, load);
  }
  for (const [text, load] of longest) labels.set(load, text);
  return labels;
}

function drawSupport(context, support, x, y, colour) {
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 1.8;
  const zigzag = [[0, 0], [6, 0], [8, 5], [12, -5], [16, 5], [20, -5], [22, 0], [26, 0]];
  // Outside of its block.
  const right = support.on_the_right ? 1 : -1, down = support.on_top ? -1 : 1;
  const bars = [support.in_x ? (p) => [x + right * p[0], y + p[1]] : null, support.in_y ? (p) => [x + p[1], y + down * p[0]] : null];
  for (const place of bars.filter(Boolean)) {
    context.beginPath();
    zigzag.forEach((p, i) => (i ? context.lineTo(...place(p)) : context.moveTo(...place(p))));
    context.moveTo(...place([26, -8]));
    context.lineTo(...place([26, 8]));
    context.stroke();
  }
  context.beginPath();
  context.arc(x, y, 2.6, 0, 2 * Math.PI);
  context.fill();
}

/** One entry of the key after the other, from left to right and then in the next row. */
class Key {
  constructor(view) {
    this.view = view;
    this.context = view.context;
    this.context.font = "13px system-ui, sans-serif";
    this.entries = [];
  }

  add(width, text, draw) { this.entries.push({ width, text, draw, all: width + 6 + this.context.measureText(text).width + 18 }); }

  addLine(colour, width, text, dashes = []) {
    this.add(30, text, (x, y) => {
      this.context.setLineDash(dashes);
      this.context.strokeStyle = colour;
      this.context.lineWidth = width;
      this.context.beginPath();
      this.context.moveTo(x, y);
      this.context.lineTo(x + 30, y);
      this.context.stroke();
      this.context.setLineDash([]);
    });
  }

  addSwatch(colour, text) {
    this.add(22, text, (x, y) => {
      this.context.fillStyle = colour;
      this.context.fillRect(x, y - 7, 22, 14);
      this.context.strokeStyle = "#333";
      this.context.lineWidth = 0.6;
      this.context.strokeRect(x, y - 7, 22, 14);
    });
  }

  draw() {
    const rows = [[]], most = this.view.width - 20;
    let used = 0;
    for (const entry of this.entries) {
      if (used + entry.all > most && rows[rows.length - 1].length) {
        rows.push([]);
        used = 0;
      }
      rows[rows.length - 1].push(entry);
      used += entry.all;
    }
    const height = 24 * rows.length + 8, { context } = this;
    context.fillStyle = "rgba(255,255,255,0.85)";
    context.fillRect(0, this.view.height - height, this.view.width, height);
    context.lineCap = "butt";
    rows.forEach((row, r) => {
      let x = 10;
      const y = this.view.height - height + 18 + 24 * r;
      for (const entry of row) {
        entry.draw(x, y);
        context.fillStyle = "#222";
        context.fillText(entry.text, x + entry.width + 6, y + 4);
        x += entry.all;
      }
    });
  }
}

function drawKey(view) {
  const key = new Key(view), { colours, symbols } = view.results.data, { context } = view;
  const metres = roundBelow(160 / view.scale), bar = metres * view.scale;
  key.add(bar, lengthText(metres), (x, y) => {
    context.strokeStyle = "black";
    context.lineWidth = 1.4;
    context.beginPath();
    context.moveTo(x, y - 5);
    context.lineTo(x, y + 3);
    context.lineTo(x + bar, y + 3);
    context.lineTo(x + bar, y - 5);
    context.stroke();
  });
  addColours(key, view);
  if (view.results.fixed.some((fixed) => fixed)) key.addSwatch(colours.fixed, "fixed");
  if (view.layers.joints && view.shownColour === "material" && view.results.seams)
    for (const n of view.results.seams.used) key.addLine(colours.seams[n % colours.seams.length], 2.5, view.results.seams.names[n], dashesOf(n, colours.seams));
  if (view.layers.joints) {
    key.addLine(colours.sliding, 3, "slides");
    key.addLine(colours.open, 3, "open");
  }
  const contacts = view.results.contacts(view.state), cracks = view.results.cracks(view.state);
  if (view.layers.forces && contacts) key.addLine(colours.force, view.widestLine, `force ${forceText(view.forceScale())}`);
  if (view.layers.openings && cracks && cracks.largestOpening > view.results.leastOpening && !view.isMechanism) key.addLine(colours.open, view.widestLine, `largest opening ${lengthText(cracks.largestOpening)}`);
  if (view.layers.symbols) {
    if (symbols.some((symbol) => symbol.kind === "load")) key.addLine(colours.load, 2.4, "load");
    if (symbols.some((symbol) => symbol.kind === "support")) key.addLine(colours.support, 2.4, "support");
  }
  key.draw();
}

function addColours(key, view) {
  const { names, quantity, largest, shown } = view.key(), { colours } = view.results.data, { context } = key;
  if (names) {
    names.forEach((name, i) => name !== null && key.addSwatch(colours.fills[i % colours.fills.length], name));
    return;
  }
  const length = 150;
  key.add(length, `${quantity}, from 0 to ${number(shown === undefined ? largest : shown, 3)}`, (x, y) => {
    for (let i = 0; i < length; ++i) {
      context.fillStyle = gradientColour(colours.gradient, i / (length - 1));
      context.fillRect(x + i, y - 6, 1.5, 12);
    }
  });
}
