// The results as the program has put them into the page, unpacked when they are asked for.

function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const characters = atob(text), bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

const unpack = {
  f8: (text) => new Float64Array(bytesOf(text).buffer),
  f4: (text) => new Float32Array(bytesOf(text).buffer),
  i4: (text) => new Int32Array(bytesOf(text).buffer),
  u1: (text) => bytesOf(text),
};

/** Numbers of a contact in a state, in the order in which the page has them. */
const CONTACT_NUMBERS = 9, CRACK_NUMBERS = 8;
const STATUS = ["open", "sticking", "sliding"];
/** States of which the unpacked numbers are kept, so that a film of many states does not fill the memory. */
const MOST_UNPACKED = 40;

class Results {
  constructor(data) {
    this.data = data;
    this.summary = data.summary || {};
    this.isFactor = this.summary.command === "fos";
    const b = data.blocks;
    this.names = b.names;
    this.count = b.names.length;
    this.index = new Map(b.names.map((name, i) => [name, i]));
    this.materials = b.materials;
    this.material = unpack.i4(b.material_i4);
    const used = new Set(this.material);
    this.materialsInKey = b.materials.map((name, i) => (used.has(i) ? name : null));
    this.fixed = unpack.u1(b.fixed_u1);
    this.seams = data.seams ? { names: data.seams.names, blocks: unpack.i4(data.seams.blocks_i4), joints: unpack.i4(data.seams.joints_i4), ends: unpack.f4(data.seams.ends_f4) } : null;
    if (this.seams) this.seams.used = [...new Set(this.seams.joints)].sort((a, b) => a - b);
    this.area = unpack.f8(b.area_f8);
    this.mass = unpack.f8(b.mass_f8);
    this.vertices = unpack.f8(b.vertices_f8);
    this.centroids = unpack.f8(b.centroids_f8);
    this.first = new Int32Array(this.count + 1);
    const counts = unpack.i4(b.counts_i4);
    for (let i = 0; i < this.count; ++i) this.first[i + 1] = this.first[i] + counts[i];
    this.findRadii();
    this.states = data.states;
    this.unpacked = new Map();
    this.still = new Float32Array(3 * this.count);
    this.largestDisplacement = this.largestOverStates("largest_displacement");
    this.largestVelocity = this.largestOverStates("largest_velocity");
    this.usualForce = this.middleOfLargestForces();
  }

  findRadii() {
    this.radius = new Float64Array(this.count);
    const areas = [];
    for (let i = 0; i < this.count; ++i) {
      for (let k = this.first[i]; k < this.first[i + 1]; ++k) {
        const x = this.vertices[2 * k] - this.centroids[2 * i], y = this.vertices[2 * k + 1] - this.centroids[2 * i + 1];
        this.radius[i] = Math.max(this.radius[i], Math.hypot(x, y));
      }
      if (!this.fixed[i]) areas.push(this.area[i]);
    }
    areas.sort((a, b) => a - b);
    /** [m] Of the median free block. */
    this.size = areas.length ? Math.sqrt(areas[areas.length >> 1]) : Math.max(...this.radius);
  }

  /** The scale of a film is the same in all its states; states without times, of a factor of safety, have their own. */
  largestOverStates(key) {
    return Math.max(0, ...this.states.filter((state) => state.time_s !== undefined).map((state) => state[key] || 0));
  }

  middleOfLargestForces() {
    const largest = this.states.filter((state) => state.contacts).map((state) => state.contacts.largest_force).sort((a, b) => a - b);
    return largest.length ? largest[largest.length >> 1] : 0;
  }

  /** Unpacks once what is asked for again and again. */
  part(i, key, unpackPart) {
    let state = this.unpacked.get(i);
    if (!state) {
      if (this.unpacked.size >= MOST_UNPACKED) this.unpacked.delete(this.unpacked.keys().next().value);
      this.unpacked.set(i, state = {});
    }
    if (!(key in state)) state[key] = unpackPart(this.states[i]);
    return state[key];
  }

  /** Displacement x, y [m] and rotation [rad] of every block since the drawing. */
  motion(i) { return this.part(i, "motion", (state) => state.motion_f4 ? unpack.f4(state.motion_f4) : this.still); }

  /** Velocity x, y [m/s] and angular velocity [rad/s]; of a mechanism, what fails fastest has about 1. Null where there are none. */
  velocity(i) { return this.part(i, "velocity", (state) => state.velocity_f4 ? unpack.f4(state.velocity_f4) : null); }

  contacts(i) {
    return this.part(i, "contacts", (state) => {
      const packed = state.contacts;
      if (!packed) return null;
      const status = unpack.u1(packed.status_u1);
      return { count: status.length, status, blocks: unpack.i4(packed.blocks_i4), numbers: unpack.f4(packed.numbers_f4), largestForce: packed.largest_force };
    });
  }

  contact(i, k) {
    const c = this.contacts(i), n = c.numbers.subarray(CONTACT_NUMBERS * k, CONTACT_NUMBERS * (k + 1));
    return {
      a: c.blocks[2 * k], b: c.blocks[2 * k + 1], x: n[0], y: n[1], normalX: n[2], normalY: n[3], length: n[4], gap: n[5],
      normalForce: n[6], shearForce: n[7], reach: n[8], status: c.status[k],
    };
  }

  /** [m] An opening below is the rounding of places. */
  get leastOpening() { return this.data.rounding_of_openings * this.size; }

  cracks(i) {
    return this.part(i, "cracks", (state) => {
      const packed = state.cracks;
      if (!packed) return null;
      const blocks = unpack.i4(packed.blocks_i4);
      return { count: blocks.length / 2, blocks, numbers: unpack.f4(packed.numbers_f4), largestOpening: packed.largest_opening };
    });
  }

  label(i) {
    const state = this.states[i];
    if (state.is_mechanism) return "failed (the mechanism)";
    if (state.name === "initial") return "initial (the drawing)";
    return state.time_s === undefined || state.name.startsWith("t=") ? state.name : `${state.name}, t = ${number(state.time_s)} s`;
  }
}

/** Six digits, as the command prints them. */
function number(value, digits = 6) {
  if (value === null || value === undefined || !isFinite(value)) return "-";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e-4 && size < 1e7 ? String(Number(value.toPrecision(digits))) : Number(value.toPrecision(digits)).toExponential();
}
