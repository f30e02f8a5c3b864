// Curves over an axis: ticks at round numbers, what is under the pointer in numbers, lines that can be switched off.

const CURVE_COLOURS = ["#1f5fa8", "#d95f0e", "#1a8a4a", "#8e2b8e", "#b8860b", "#c0392b", "#0e8f9c", "#5d6d7e", "#7a5230", "#e377c2", "#6b8e23", "#333333"];
/** [px] Around the curves. */
const CHART_MARGIN = { left: 74, right: 14, top: 10, bottom: 38 };
/** [px] Of a label of a vertical line, and how far from its line it may stand, beyond a curve or another line: its colour tells whose it is. */
const LABEL_HEIGHT = 16, FARTHEST_LABEL = 150;

/** Some five round numbers from low to high. */
function ticks(low, high, wanted) {
  const step = (() => {
    const least = (high - low) / wanted, power = 10 ** Math.floor(Math.log10(least));
    return power * [1, 2, 5, 10].find((digit) => digit * power >= least * (1 - 1e-9));
  })();
  const list = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) list.push(i * step);
  return list;
}

/** Short enough to stand beside the axis. */
function tickText(value) {
  return Math.abs(value) >= 1e5 ? Number(value.toPrecision(6)).toExponential().replace("e+", "e") : number(value);
}

class Chart {
  /**
   * series: [{name, x, y, marks?: "dot" | "cross" | "ring", line?: false}]; lines: [{x, text, colour}] are vertical ones, which draw() gives their
   * labels: [{text, left, right, top, bottom}].
   * onPick(x) is called for a click on the curves.
   */
  constructor(parent, { title, xLabel, yLabel, note, onPick }) {
    this.box = element("div", { className: "picture" }, parent);
    this.bar = element("div", { className: "bar" }, this.box);
    element("h2", { textContent: title }, this.bar);
    this.canvas = element("canvas", { chart: this }, this.box);
    this.keys = element("div", { className: "keys" }, this.box);
    if (note) element("p", { className: "note", textContent: note }, this.box);
    Object.assign(this, { xLabel, yLabel, onPick, series: [], lines: [], hidden: new Set(), cursor: null, pointer: null });
    this.canvas.addEventListener("pointermove", (event) => this.point(event));
    this.canvas.addEventListener("pointerleave", () => {
      this.pointer = null;
      this.draw();
    });
    this.canvas.addEventListener("click", (event) => {
      if (this.onPick && this.toX) this.onPick(this.toX(event.offsetX));
    });
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  set(series, { yLabel, lines } = {}) {
    this.series = series;
    if (yLabel) this.yLabel = yLabel;
    this.lines = lines || [];
    this.keys.replaceChildren();
    series.forEach((curve, i) => {
      curve.colour = curve.colour || CURVE_COLOURS[i % CURVE_COLOURS.length];
      if (!curve.name) return;
      const label = element("label", {}, this.keys);
      const box = element("input", { type: "checkbox", checked: !this.hidden.has(curve.name) }, label);
      element("i", {}, label).style.background = curve.colour;
      label.append(curve.name);
      box.addEventListener("change", () => {
        if (box.checked) this.hidden.delete(curve.name);
        else this.hidden.add(curve.name);
        this.draw();
      });
    });
    this.draw();
  }

  shown() { return this.series.filter((curve) => !this.hidden.has(curve.name)); }

  range() {
    let left = Infinity, right = -Infinity, low = Infinity, high = -Infinity;
    for (const { x, y } of this.shown()) {
      for (let i = 0; i < x.length; ++i) {
        if (!isFinite(x[i]) || !isFinite(y[i])) continue;
        left = Math.min(left, x[i]);
        right = Math.max(right, x[i]);
        low = Math.min(low, y[i]);
        high = Math.max(high, y[i]);
      }
    }
    for (const line of this.lines) {
      left = Math.min(left, line.x);
      right = Math.max(right, line.x);
    }
    if (left > right) return null;
    const widen = (a, b) => (b > a ? [a, b] : [a - (Math.abs(a) || 1) * 0.5, b + (Math.abs(b) || 1) * 0.5]);
    [left, right] = widen(left, right);
    if (low > high) [low, high] = [0, 1];
    [low, high] = widen(low, high);
    const room = 0.04 * (high - low);
    return { left, right, low: low - room, high: high + room };
  }

  draw() {
    const box = this.canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1, context = this.canvas.getContext("2d");
    if (box.width < 10) return;
    this.canvas.width = Math.round(box.width * ratio);
    this.canvas.height = Math.round(box.height * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, box.width, box.height);
    const range = this.range(), margin = CHART_MARGIN;
    if (!range) return;
    const width = box.width - margin.left - margin.right, height = box.height - margin.top - margin.bottom;
    this.atX = (x) => margin.left + ((x - range.left) / (range.right - range.left)) * width;
    this.atY = (y) => margin.top + ((range.high - y) / (range.high - range.low)) * height;
    this.toX = (px) => range.left + ((px - margin.left) / width) * (range.right - range.left);
    this.drawAxes(context, range, width, height);
    context.save();
    context.beginPath();
    context.rect(margin.left - 6, margin.top - 6, width + 12, height + 12);
    context.clip();
    for (const curve of this.shown()) this.drawCurve(context, curve);
    context.restore();
    if (this.cursor !== null) this.drawVertical(context, this.cursor, "#888", height);
    for (const line of this.lines) this.drawVertical(context, line.x, line.colour, height);
    this.labels = this.placedLabels(context, height);
    for (const label of this.labels) write(context, label.text, label.left, label.bottom - 4, label.colour);
    if (this.pointer) this.drawPointer(context, height);
  }

  drawAxes(context, range, width, height) {
    const margin = CHART_MARGIN;
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = "#444";
    context.lineWidth = 1;
    context.textAlign = "center";
    for (const x of ticks(range.left, range.right, Math.max(3, width / 90))) {
      context.strokeStyle = "#eee";
      context.beginPath();
      context.moveTo(this.atX(x), margin.top);
      context.lineTo(this.atX(x), margin.top + height);
      context.stroke();
      context.fillText(tickText(x), this.atX(x), margin.top + height + 15);
    }
    context.textAlign = "right";
    for (const y of ticks(range.low, range.high, 5)) {
      context.strokeStyle = y === 0 ? "#bbb" : "#eee";
      context.beginPath();
      context.moveTo(margin.left, this.atY(y));
      context.lineTo(margin.left + width, this.atY(y));
      context.stroke();
      context.fillText(tickText(y), margin.left - 5, this.atY(y) + 4);
    }
    context.strokeStyle = "#999";
    context.strokeRect(margin.left, margin.top, width, height);
    context.textAlign = "center";
    context.fillText(this.xLabel, margin.left + width / 2, margin.top + height + 32);
    context.save();
    context.translate(12, margin.top + height / 2);
    context.rotate(-Math.PI / 2);
    context.fillText(this.yLabel, 0, 0);
    context.restore();
    context.textAlign = "left";
  }

  drawCurve(context, { x, y, colour, marks, line }) {
    context.strokeStyle = context.fillStyle = colour;
    context.lineWidth = 1.6;
    context.lineJoin = "round";
    if (line !== false) {
      context.beginPath();
      let isNew = true;
      for (let i = 0; i < x.length; ++i) {
        if (!isFinite(y[i])) {
          isNew = true;
          continue;
        }
        if (isNew) context.moveTo(this.atX(x[i]), this.atY(y[i]));
        else context.lineTo(this.atX(x[i]), this.atY(y[i]));
        isNew = false;
      }
      context.stroke();
    }
    if (!marks) return;
    for (let i = 0; i < x.length; ++i) {
      const px = this.atX(x[i]), py = this.atY(y[i]);
      context.beginPath();
      if (marks === "cross") {
        context.moveTo(px - 4, py - 4);
        context.lineTo(px + 4, py + 4);
        context.moveTo(px - 4, py + 4);
        context.lineTo(px + 4, py - 4);
        context.stroke();
      } else {
        context.arc(px, py, 4, 0, 2 * Math.PI);
        if (marks === "ring") context.stroke();
        else context.fill();
      }
    }
  }

  drawVertical(context, x, colour, height) {
    context.strokeStyle = colour;
    context.setLineDash([5, 4]);
    context.lineWidth = 1.2;
    context.beginPath();
    context.moveTo(this.atX(x), CHART_MARGIN.top);
    context.lineTo(this.atX(x), CHART_MARGIN.top + height);
    context.stroke();
    context.setLineDash([]);
  }

  /** The texts of the vertical lines, as near to the upper end of each as they lie over no curve, line or other text. One that finds no room is left out. */
  placedLabels(context, height) {
    const placed = [], right = this.canvas.clientWidth - CHART_MARGIN.right;
    const lines = this.lines.map((line) => this.atX(line.x)), points = this.drawnPoints();
    context.font = "12px system-ui, sans-serif";
    const isFree = (box) => box.left >= CHART_MARGIN.left && box.right <= right && !lines.some((x) => x > box.left && x < box.right)
      && !points.some(([x, y]) => x > box.left - 5 && x < box.right + 5 && y > box.top - 5 && y < box.bottom + 5)
      && !placed.some((other) => other.left < box.right && box.left < other.right && other.top < box.bottom && box.top < other.bottom);
    for (const line of this.lines) {
      const x = this.atX(line.x), width = context.measureText(line.text).width, boxes = [];
      for (let top = CHART_MARGIN.top + 2; top + LABEL_HEIGHT <= CHART_MARGIN.top + height; top += LABEL_HEIGHT) {
        for (let away = 5; away <= FARTHEST_LABEL; away += 5) {
          for (const left of [x + away, x - away - width]) boxes.push({ away, left, right: left + width, top, bottom: top + LABEL_HEIGHT });
        }
      }
      const free = boxes.sort((one, other) => one.away + one.top - other.away - other.top).find(isFree);
      if (free) placed.push({ ...free, text: line.text, colour: line.colour });
    }
    return placed;
  }

  /** [px] Of the curves, close enough to each other that no text fits between two of them. */
  drawnPoints() {
    const points = [];
    for (const { x, y, line } of this.shown()) {
      for (let i = 0; i < x.length; ++i) {
        const end = [this.atX(x[i]), this.atY(y[i])];
        if (!isFinite(end[1])) continue;
        points.push(end);
        if (line === false || i === 0 || !isFinite(y[i - 1])) continue;
        const begin = [this.atX(x[i - 1]), this.atY(y[i - 1])], pieces = Math.ceil(Math.hypot(end[0] - begin[0], end[1] - begin[1]) / 5);
        for (let k = 1; k < pieces; ++k) points.push([0, 1].map((axis) => begin[axis] + (k / pieces) * (end[axis] - begin[axis])));
      }
    }
    return points;
  }

  point(event) {
    this.pointer = { x: event.offsetX, y: event.offsetY };
    this.draw();
  }

  /** The nearest points of the curves at the place of the pointer. */
  drawPointer(context, height) {
    const x = this.toX(this.pointer.x), lines = [];
    let shownX = null;
    for (const curve of this.shown()) {
      let nearest = -1;
      for (let i = 0; i < curve.x.length; ++i) if (nearest < 0 || Math.abs(curve.x[i] - x) < Math.abs(curve.x[nearest] - x)) nearest = i;
      if (nearest < 0 || !isFinite(curve.y[nearest])) continue;
      shownX = shownX === null || Math.abs(curve.x[nearest] - x) < Math.abs(shownX - x) ? curve.x[nearest] : shownX;
      lines.push({ text: `${curve.name ? curve.name + " " : ""}${number(curve.y[nearest])}`, colour: curve.colour });
    }
    if (shownX === null) return;
    this.drawVertical(context, shownX, "#bbb", height);
    lines.unshift({ text: `${this.xLabel} ${number(shownX)}`, colour: "#222" });
    context.font = "12px system-ui, sans-serif";
    const width = Math.max(...lines.map((line) => context.measureText(line.text).width)) + 12;
    const left = this.pointer.x + 14 + width > this.canvas.clientWidth ? this.pointer.x - 14 - width : this.pointer.x + 14;
    context.fillStyle = "rgba(255,255,255,0.92)";
    context.strokeStyle = "#bbb";
    context.fillRect(left, 14, width, 15 * lines.length + 8);
    context.strokeRect(left, 14, width, 15 * lines.length + 8);
    lines.forEach((line, i) => {
      context.fillStyle = line.colour;
      context.fillText(line.text, left + 6, 29 + 15 * i);
    });
  }
}

function element(tag, properties, parent) {
  const made = Object.assign(document.createElement(tag), properties);
  if (parent) parent.append(made);
  return made;
}

/** A table of [what, value, class?]. */
function addTable(parent, rows, id) {
  const table = element("table", id ? { id } : {}, parent);
  for (const [what, value, quality] of rows) {
    const row = element("tr", {}, table);
    element("th", { textContent: what }, row);
    element("td", { textContent: value, className: `number ${quality || ""}` }, row);
  }
  return table;
}
