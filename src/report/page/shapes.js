// Where the blocks of a state are on the screen, and which block or contact is at a place.

/** Cosine and sine of a turn; of a mechanism to first order, as velocities are, so that blocks that turn as one body stay joined. */
function turnBy(angle, toFirstOrder) { return toFirstOrder ? [1, angle] : [Math.cos(angle), Math.sin(angle)]; }

/** Vertices of all blocks moved as rigid bodies; amplitude scales the motion (rotation included). Metres from the origin of the page. */
function movedVertices(results, motion, amplitude, toFirstOrder, into) {
  const { first, centroids, vertices, count } = results;
  for (let b = 0; b < count; ++b) {
    const cx = centroids[2 * b], cy = centroids[2 * b + 1];
    const x = cx + amplitude * motion[3 * b], y = cy + amplitude * motion[3 * b + 1], turn = amplitude * motion[3 * b + 2];
    if (turn === 0) {
      for (let k = 2 * first[b]; k < 2 * first[b + 1]; k += 2) {
        into[k] = vertices[k] - cx + x;
        into[k + 1] = vertices[k + 1] - cy + y;
      }
      continue;
    }
    const [c, s] = turnBy(turn, toFirstOrder);
    for (let k = 2 * first[b]; k < 2 * first[b + 1]; k += 2) {
      const u = vertices[k] - cx, v = vertices[k + 1] - cy;
      into[k] = x + c * u - s * v;
      into[k + 1] = y + s * u + c * v;
    }
  }
  return into;
}

/** A point of the drawing on a block, moved with it. */
function carriedPoint(results, motion, amplitude, toFirstOrder, block, point) {
  const cx = results.centroids[2 * block], cy = results.centroids[2 * block + 1];
  const u = point[0] - cx, v = point[1] - cy, [c, s] = turnBy(amplitude * motion[3 * block + 2], toFirstOrder);
  return [cx + amplitude * motion[3 * block] + c * u - s * v, cy + amplitude * motion[3 * block + 1] + s * u + c * v];
}

function isInside(places, from, to, x, y) {
  let inside = false;
  for (let k = from, last = to - 1; k < to; last = k++) {
    const ax = places[2 * k], ay = places[2 * k + 1], bx = places[2 * last], by = places[2 * last + 1];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
  }
  return inside;
}

/** The block at a place, or -1. */
function blockAt(results, places, x, y) {
  for (let b = results.count - 1; b >= 0; --b) {
    if (isInside(places, results.first[b], results.first[b + 1], x, y)) return b;
  }
  return -1;
}

/** The contacts not farther than this [m], the nearest first. */
function contactsAt(contacts, x, y, farthest) {
  const found = [];
  for (let k = 0; k < contacts.count; ++k) {
    const n = CONTACT_NUMBERS * k, away = Math.hypot(contacts.numbers[n] - x, contacts.numbers[n + 1] - y);
    if (away < farthest) found.push({ contact: k, away });
  }
  return found.sort((a, b) => a.away - b.away).map((one) => one.contact);
}

/** 1, 2 or 5 times a power of ten, not above the value. */
function roundBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return value >= 5 * power ? 5 * power : value >= 2 * power ? 2 * power : power;
}

function forceText(newtons) {
  newtons = Number(newtons.toPrecision(4));
  if (newtons >= 1e6) return `${number(newtons * 1e-6, 4)} MN/m`;
  return newtons >= 1e3 ? `${number(newtons * 1e-3, 4)} kN/m` : `${number(newtons, 4)} N/m`;
}

function pressureText(pascals) {
  pascals = Number(pascals.toPrecision(4));
  if (pascals >= 1e6) return `${number(pascals * 1e-6, 4)} MPa`;
  return pascals >= 1e3 ? `${number(pascals * 1e-3, 4)} kPa` : `${number(pascals, 4)} Pa`;
}

function lengthText(metres) {
  metres = Number(metres.toPrecision(4));
  if (metres >= 1) return `${number(metres, 4)} m`;
  return metres >= 1e-3 ? `${number(metres * 1e3, 4)} mm` : `${number(metres * 1e6, 4)} \u00b5m`;
}
