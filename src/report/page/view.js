// The picture of a state on a canvas: what is drawn, how it is zoomed and moved, and what a click meets.

/** Blocks in one path, and lines: the time that a browser takes for a path grows faster than its length (10,000 blocks: 49 pictures a second with
 *  paths of 20, 20 with paths of 250). */
const BLOCKS_A_PATH = 16, LINES_A_PATH = 64;
/** Steps of colour and of width that are told apart; each is one path. */
const COLOUR_STEPS = 32, WIDTH_STEPS = 12;
/** [-] Forces and openings below this part of the largest are thinner than a line can be drawn. */
const LEAST_DRAWN_PART = 0.005;
/** [-] Of the largest motion of the mechanism: what opens or slips by less has been moved by rounding. */
const NOTICEABLE_PART = 0.01;
/** [px] Farther from a contact, a click means the block. Of small blocks, the part of their size that stands below. */
const CONTACT_REACH = 7, CONTACT_PART = 0.2;
/** [px] Shorter ways of the pointer are a click. */
const CLICK_WAY = 4;
/** Names are written beside no more points and loads than this. */
const MOST_LABELS = 12;
const FIXED_CLASS = COLOUR_STEPS + 1;
const TOUCH_NAMES = ["touched by nothing", "held by friction or cohesion", "something slides along it"];

class View {
  constructor(results, canvas) {
    this.results = results;
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.state = 0;
    this.amplitude = 1;
    this.colour = "material";
    this.layers = { joints: true, forces: false, openings: false, velocities: false, symbols: true };
    this.selected = null;
    this.onSelect = () => {};
    this.places = new Float64Array(results.vertices.length);
    this.screen = new Float32Array(results.vertices.length);
    this.classes = new Uint8Array(results.count);
    this.order = new Int32Array(results.count);
    /** Pictures so far, and what they took [ms]: for whoever measures. */
    this.pictures = 0;
    this.drawingTime = 0;
    this.waiting = false;
    this.resize();
    this.fit(results.vertices);
    this.listen();
  }

  get motion() { return this.results.motion(this.state); }
  get isMechanism() { return Boolean(this.results.states[this.state].is_mechanism); }
  /** Only the mechanism can be drawn moved by more or less than it is. */
  get shownAmplitude() { return this.isMechanism ? this.amplitude : 1; }

  resize() {
    const box = this.canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
    this.width = Math.max(50, box.width);
    this.height = Math.max(50, box.height);
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.ratio = ratio;
  }

  /** Shows all of these places. */
  fit(places) {
    let left = Infinity, right = -Infinity, low = Infinity, high = -Infinity;
    for (let k = 0; k < places.length; k += 2) {
      left = Math.min(left, places[k]);
      right = Math.max(right, places[k]);
      low = Math.min(low, places[k + 1]);
      high = Math.max(high, places[k + 1]);
    }
    this.scale = Math.min((this.width - 40) / (right - left), (this.height - 90) / (high - low));
    this.x = 0.5 * (left + right);
    this.y = 0.5 * (low + high) - 20 / this.scale;
    this.request();
  }

  toScreen(x, y) { return [0.5 * this.width + (x - this.x) * this.scale, 0.5 * this.height - (y - this.y) * this.scale]; }
  toPlace(px, py) { return [this.x + (px - 0.5 * this.width) / this.scale, this.y - (py - 0.5 * this.height) / this.scale]; }

  show(state) {
    this.state = state;
    if (this.selected && this.selected.kind === "contact") this.selected = null;
    this.request();
  }

  /** Draws before the next picture of the screen, once however often it is asked. */
  request() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  draw() {
    const begin = performance.now();
    const context = this.context;
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.fillStyle = "white";
    context.fillRect(0, 0, this.width, this.height);
    movedVertices(this.results, this.motion, this.shownAmplitude, this.isMechanism, this.places);
    for (let k = 0; k < this.places.length; k += 2) {
      this.screen[k] = 0.5 * this.width + (this.places[k] - this.x) * this.scale;
      this.screen[k + 1] = 0.5 * this.height - (this.places[k + 1] - this.y) * this.scale;
    }
    this.findClasses();
    this.findOrder();
    this.drawBlocks();
    if (this.layers.joints) this.drawJoints();
    if (this.layers.openings) this.drawOpenings();
    if (this.layers.forces) this.drawForces();
    if (this.layers.velocities) this.drawVelocities();
    if (this.layers.symbols) drawSymbols(this);
    this.drawSelected();
    drawKey(this);
    this.drawingTime += performance.now() - begin;
    ++this.pictures;
  }

  /** [px] Of the median free block. */
  get blockSize() { return this.results.size * this.scale; }

  /** What the colours show of this state: what it has not falls back to the materials. */
  get shownColour() {
    if (this.colour === "velocity" && !this.results.velocity(this.state)) return "material";
    if (this.colour === "contacts" && !this.results.contacts(this.state)) return "material";
    return this.colour;
  }

  /** What the colours tell: {quantity, largest} of a number, or {names} of classes. */
  key() {
    const state = this.results.states[this.state];
    if (this.shownColour === "material") return { names: this.results.materialsInKey };
    if (this.shownColour === "contacts") return { names: TOUCH_NAMES };
    const isFilm = state.time_s !== undefined;
    if (this.shownColour === "velocity") {
      const largest = isFilm ? this.results.largestVelocity : state.largest_velocity || 0;
      return this.isMechanism ? { quantity: "velocity / largest velocity", largest, shown: 1 } : { quantity: "velocity [m/s]", largest };
    }
    const largest = isFilm ? this.results.largestDisplacement : state.largest_displacement || 0;
    if (this.isMechanism) return { quantity: "motion / largest", largest, shown: 1 };
    return largest < 0.1 ? { quantity: "displacement [mm]", largest, shown: 1e3 * largest } : { quantity: "displacement [m]", largest };
  }

  findClasses() {
    const { results, classes } = this;
    const touched = this.shownColour === "contacts" ? this.touchedBlocks() : null;
    const triples = this.shownColour === "velocity" ? results.velocity(this.state) : this.shownColour === "displacement" ? this.motion : null;
    const largest = this.key().largest || Infinity;
    for (let b = 0; b < results.count; ++b) {
      if (results.fixed[b]) classes[b] = FIXED_CLASS;
      else if (touched) classes[b] = touched[b];
      else if (this.shownColour === "material") classes[b] = results.material[b] % results.data.colours.fills.length;
      else classes[b] = triples ? Math.min(COLOUR_STEPS, Math.round((COLOUR_STEPS * Math.hypot(triples[3 * b], triples[3 * b + 1])) / largest)) : 0;
    }
  }

  touchedBlocks() {
    const touched = new Uint8Array(this.results.count), contacts = this.results.contacts(this.state);
    for (let k = 0; contacts && k < contacts.count; ++k) {
      if (contacts.status[k] === 0) continue;
      for (const b of [contacts.blocks[2 * k], contacts.blocks[2 * k + 1]]) touched[b] = Math.max(touched[b], contacts.status[k]);
    }
    return touched;
  }

  fillOf(colourClass) {
    const colours = this.results.data.colours;
    if (colourClass === FIXED_CLASS) return colours.fixed;
    return this.key().names ? colours.fills[colourClass] : gradientColour(colours.gradient, colourClass / COLOUR_STEPS);
  }

  /** The blocks that are to be seen, those of a colour together. */
  findOrder() {
    const { results, classes, order, screen } = this, counts = new Int32Array(FIXED_CLASS + 2);
    const seen = this.seen || (this.seen = new Uint8Array(results.count));
    for (let b = 0; b < results.count; ++b) {
      const k = 2 * results.first[b], reach = 2 * results.radius[b] * this.scale;
      const x = screen[k], y = screen[k + 1];
      seen[b] = x > -reach && y > -reach && x < this.width + reach && y < this.height + reach ? 1 : 0;
      if (seen[b]) ++counts[classes[b] + 1];
    }
    for (let c = 0; c <= FIXED_CLASS; ++c) counts[c + 1] += counts[c];
    this.shown = counts[FIXED_CLASS + 1];
    for (let b = 0; b < results.count; ++b) if (seen[b]) order[counts[classes[b]]++] = b;
  }

  tracePolygon(path, b) {
    const { screen } = this, from = 2 * this.results.first[b], to = 2 * this.results.first[b + 1];
    path.moveTo(screen[from], screen[from + 1]);
    for (let k = from + 2; k < to; k += 2) path.lineTo(screen[k], screen[k + 1]);
    path.closePath();
  }

  drawBlocks() {
    const { context, order, classes } = this, paths = [];
    for (let begin = 0; begin < this.shown; ) {
      const colourClass = classes[order[begin]], path = new Path2D();
      let end = begin;
      while (end < this.shown && end - begin < BLOCKS_A_PATH && classes[order[end]] === colourClass) this.tracePolygon(path, order[end++]);
      context.fillStyle = this.fillOf(colourClass);
      context.fill(path);
      paths.push(path);
      begin = end;
    }
    // After all the fills, or a neighbour would cover half of an outline.
    context.lineJoin = "round";
    context.strokeStyle = this.results.data.colours.outline;
    context.lineWidth = Math.min(0.9, Math.max(0.08, 0.02 * this.blockSize));
    for (const path of paths) context.stroke(path);
  }

  /** Joints with a name, which move with the first of their blocks; beneath what slides or opens. */
  drawSeams() {
    const { seams } = this.results, { context } = this, colours = this.results.data.colours.seams;
    if (!seams || this.shownColour !== "material") return;
    const lines = seams.names.map(() => []);
    seams.joints.forEach((joint, k) => {
      for (const n of [4 * k, 4 * k + 2])
        lines[joint].push(...this.toScreen(...carriedPoint(this.results, this.motion, this.shownAmplitude, this.isMechanism, seams.blocks[k], [seams.ends[n], seams.ends[n + 1]])));
    });
    context.lineCap = "butt";
    context.lineWidth = Math.min(2.5, Math.max(0.4, 0.05 * this.blockSize));
    lines.forEach((ends, joint) => {
      context.strokeStyle = colours[joint % colours.length];
      context.setLineDash(dashesOf(joint, colours));
      this.strokeLines(ends);
    });
    context.setLineDash([]);
  }

  drawJoints() {
    this.drawSeams();
    const lines = { sliding: [], open: [] }, dots = [];
    const contacts = this.results.contacts(this.state);
    if (contacts) this.jointsOfContacts(contacts, lines, dots);
    else if (this.isMechanism) this.jointsOfMechanism(lines);
    const { context } = this, colours = this.results.data.colours, width = Math.min(3, Math.max(0.25, 0.06 * this.blockSize));
    context.lineCap = "round";
    for (const kind of ["sliding", "open"]) {
      context.strokeStyle = colours[kind];
      context.lineWidth = width;
      this.strokeLines(lines[kind]);
    }
    context.fillStyle = colours.sliding;
    for (let i = 0; i < dots.length; i += 2) context.fillRect(dots[i] - width, dots[i + 1] - width, 2 * width, 2 * width);
  }

  jointsOfContacts(contacts, lines, dots) {
    const { numbers, status } = contacts;
    for (let k = 0; k < contacts.count; ++k) {
      if (status[k] === 1) continue;
      // What touches without a force is closed.
      if (status[k] === 0 && numbers[CONTACT_NUMBERS * k + 5] <= this.results.leastOpening) continue;
      const n = CONTACT_NUMBERS * k, [x, y] = this.toScreen(numbers[n], numbers[n + 1]), reach = numbers[n + 8] * this.scale;
      if (reach !== 0) lines[STATUS[status[k]]].push(x, y, x - numbers[n + 3] * reach, y - numbers[n + 2] * reach);
      else if (status[k] === 2) dots.push(x, y);
    }
  }

  jointsOfMechanism(lines) {
    const cracks = this.results.cracks(this.state);
    const noticeable = NOTICEABLE_PART * this.largestMotion();
    this.eachHalfCrack(cracks, (from, to, opening, slip) => {
      if (opening > noticeable) lines.open.push(...from, ...to);
      else if (Math.abs(slip) > noticeable) lines.sliding.push(...from, ...to);
    });
  }

  /** [m] Of a point of a block, at most. */
  largestMotion() {
    const { motion, results } = this;
    let largest = 0;
    for (let b = 0; b < results.count; ++b)
      largest = Math.max(largest, Math.hypot(motion[3 * b], motion[3 * b + 1]) + Math.abs(motion[3 * b + 2]) * results.radius[b]);
    return largest;
  }

  /** Half of a joint stands for each of its ends. Its places are those of the state as it is, not of another amplitude. */
  eachHalfCrack(cracks, visit) {
    if (!cracks || this.shownAmplitude !== 1) return;
    for (let k = 0; k < cracks.count; ++k) {
      const n = cracks.numbers.subarray(CRACK_NUMBERS * k, CRACK_NUMBERS * (k + 1));
      const from = this.toScreen(n[0], n[1]), to = this.toScreen(n[2], n[3]), middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
      visit(from, middle, n[4], n[6]);
      visit(middle, to, n[5], n[7]);
    }
  }

  strokeLines(ends) {
    for (let begin = 0; begin < ends.length; begin += 4 * LINES_A_PATH) {
      this.context.beginPath();
      for (let i = begin; i < Math.min(ends.length, begin + 4 * LINES_A_PATH); i += 4) {
        this.context.moveTo(ends[i], ends[i + 1]);
        this.context.lineTo(ends[i + 2], ends[i + 3]);
      }
      this.context.stroke();
    }
  }

  /** [px] Of the widest line that stands for a size. */
  get widestLine() { return Math.min(14, Math.max(1.5, 0.3 * this.blockSize)); }

  /** Lines as wide as they are large; sizes from 0 to about 1. */
  drawSized(colour, opacity, eachLine) {
    const lines = Array.from({ length: 2 * WIDTH_STEPS }, () => []), { context } = this;
    eachLine((size, x1, y1, x2, y2) => {
      if (size < LEAST_DRAWN_PART) return;
      lines[Math.min(lines.length - 1, Math.floor(size * WIDTH_STEPS))].push(x1, y1, x2, y2);
    });
    context.strokeStyle = colour;
    context.globalAlpha = opacity;
    context.lineCap = "round";
    lines.forEach((ends, step) => {
      context.lineWidth = (this.widestLine * (step + 0.5)) / WIDTH_STEPS;
      this.strokeLines(ends);
    });
    context.globalAlpha = 1;
  }

  drawOpenings() {
    const cracks = this.results.cracks(this.state);
    if (!cracks || cracks.largestOpening <= this.results.leastOpening) return;
    this.drawSized(this.results.data.colours.open, 0.8, (line) =>
      this.eachHalfCrack(cracks, (from, to, opening) => { if (opening > 0) line(opening / cracks.largestOpening, ...from, ...to); }));
  }

  drawForces() {
    const pairs = this.results.part(this.state, "pairs", () => resultants(this.results, this.results.contacts(this.state)));
    const usual = this.forceScale();
    this.drawSized(this.results.data.colours.force, 0.72, (line) => {
      for (const pair of pairs) {
        const size = Math.hypot(pair.fx, pair.fy), ux = pair.fx / size, uy = pair.fy / size;
        const into = (b) => Math.min(0.5 * Math.sqrt(this.results.area[b]), this.results.fixed[b] ? 0.25 * this.results.size : Infinity);
        const a = into(pair.a), b = into(pair.b);
        line(size / usual, ...this.toScreen(pair.x + a * ux, pair.y + a * uy), ...this.toScreen(pair.x - b * ux, pair.y - b * uy));
      }
    });
  }

  /** [N] That is drawn with the widest line: in a film the same in all states. */
  forceScale() {
    const contacts = this.results.contacts(this.state);
    return (this.results.states[this.state].time_s !== undefined ? this.results.usualForce : contacts && contacts.largestForce) || 1;
  }

  /** One arrow in each cell of a grid, or they would cover each other: the fastest there. */
  drawVelocities() {
    const velocity = this.results.velocity(this.state);
    const fastest = this.results.states[this.state].largest_velocity || 0;
    if (!velocity || fastest === 0) return;
    const longest = Math.min(60, Math.max(22, 1.1 * this.blockSize)), cells = new Map();
    for (let i = 0; i < this.shown; ++i) {
      const b = this.order[i], speed = Math.hypot(velocity[3 * b], velocity[3 * b + 1]);
      if (speed < 0.03 * fastest) continue;
      const [x, y] = this.toScreen(...this.centroidOf(b)), cell = `${Math.round(x / (0.75 * longest))},${Math.round(y / (0.75 * longest))}`;
      const other = cells.get(cell);
      if (!other || other.speed < speed) cells.set(cell, { b, x, y, speed });
    }
    for (const { b, x, y } of cells.values()) {
      const vx = (longest / fastest) * velocity[3 * b], vy = (-longest / fastest) * velocity[3 * b + 1];
      drawArrow(this.context, x, y, x + vx, y + vy, "black", 1.4, 8);
    }
  }

  centroidOf(b) { return carriedPoint(this.results, this.motion, this.shownAmplitude, this.isMechanism, b, [this.results.centroids[2 * b], this.results.centroids[2 * b + 1]]); }

  drawSelected() {
    if (!this.selected) return;
    const { context } = this, outline = (b, width) => {
      const path = new Path2D();
      this.tracePolygon(path, b);
      context.strokeStyle = "#0b5cad";
      context.lineWidth = width;
      context.stroke(path);
    };
    if (this.selected.kind === "block") return outline(this.selected.block, 3);
    const contact = this.results.contact(this.state, this.selected.contact), [x, y] = this.toScreen(contact.x, contact.y);
    for (const b of [contact.a, contact.b]) outline(b, 1.5);
    context.beginPath();
    context.arc(x, y, 6, 0, 2 * Math.PI);
    context.lineWidth = 2.5;
    context.stroke();
  }

  select(selected) {
    this.selected = selected;
    this.request();
    this.onSelect(selected);
  }

  /** What is at these pixels: contacts that are very near, then a block. A further click at the same place takes the next of them. */
  pick(px, py) {
    const [x, y] = this.toPlace(px, py), contacts = this.results.contacts(this.state);
    const farthest = Math.min(CONTACT_REACH, CONTACT_PART * this.blockSize) / this.scale;
    const found = (contacts ? contactsAt(contacts, x, y, farthest) : []).map((contact) => ({ kind: "contact", contact }));
    movedVertices(this.results, this.motion, this.shownAmplitude, this.isMechanism, this.places);
    const block = blockAt(this.results, this.places, x, y);
    if (block >= 0) found.push({ kind: "block", block });
    if (!found.length) return null;
    const isRepeated = this.lastClick && Math.hypot(px - this.lastClick[0], py - this.lastClick[1]) < CLICK_WAY;
    this.lastClick = [px, py];
    const chosen = isRepeated && this.selected ? found.findIndex((one) => one.kind === this.selected.kind && one[one.kind] === this.selected[one.kind]) : -1;
    return found[(chosen + 1) % found.length];
  }

  zoom(px, py, factor) {
    const [x, y] = this.toPlace(px, py);
    this.scale *= factor;
    this.x = x - (px - 0.5 * this.width) / this.scale;
    this.y = y + (py - 0.5 * this.height) / this.scale;
    this.request();
  }

  listen() {
    const pointers = new Map(), { canvas } = this;
    let way = 0;
    const at = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
    const apart = () => { const [a, b] = [...pointers.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(...at(event), Math.exp(-0.0015 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, at(event));
      if (pointers.size === 1) way = 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const last = pointers.get(event.pointerId);
      if (!last) return;
      const now = at(event), before = pointers.size === 2 ? apart() : 0;
      pointers.set(event.pointerId, now);
      way += Math.hypot(now[0] - last[0], now[1] - last[1]);
      if (pointers.size === 2) return this.zoom(...now, apart() / before);
      if (way <= CLICK_WAY) return;
      canvas.classList.add("moving");
      this.x -= (now[0] - last[0]) / this.scale;
      this.y += (now[1] - last[1]) / this.scale;
      this.request();
    });
    const end = (event) => {
      if (!pointers.delete(event.pointerId)) return;
      canvas.classList.remove("moving");
      if (event.type === "pointerup" && way <= CLICK_WAY) this.select(this.pick(...at(event)));
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    new ResizeObserver(() => {
      this.resize();
      this.request();
    }).observe(canvas);
  }
}

/** The resultant between any two blocks and the point it goes through, weighted by the forces. */
function resultants(results, contacts) {
  const pairs = new Map();
  for (let k = 0; contacts && k < contacts.count; ++k) {
    const n = contacts.numbers.subarray(CONTACT_NUMBERS * k, CONTACT_NUMBERS * (k + 1)), size = Math.hypot(n[6], n[7]);
    if (size === 0) continue;
    const a = contacts.blocks[2 * k], b = contacts.blocks[2 * k + 1], sign = a < b ? 1 : -1;
    const key = Math.min(a, b) * results.count + Math.max(a, b);
    let pair = pairs.get(key);
    if (!pair) pairs.set(key, pair = { a: Math.min(a, b), b: Math.max(a, b), fx: 0, fy: 0, x: 0, y: 0, weight: 0 });
    pair.fx += sign * (n[6] * n[2] - n[7] * n[3]);
    pair.fy += sign * (n[6] * n[3] + n[7] * n[2]);
    pair.x += size * n[0];
    pair.y += size * n[1];
    pair.weight += size;
  }
  const list = [...pairs.values()].filter((pair) => pair.fx !== 0 || pair.fy !== 0);
  for (const pair of list) {
    pair.x /= pair.weight;
    pair.y /= pair.weight;
  }
  return list;
}
