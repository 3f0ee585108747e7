// Parts of the robot as they are drawn: solids that are moved, surfaces whose corners move, lines.

/** Colours of what has no value of the quantity that is shown. */
const NEUTRAL = { body: "#6f8fb0", muscle: "#d9cfbc", block: "#d9cfbc" };
/** Cosine of the angle between faces below which their edge is sharp. */
const SHARP = 0.8;

/** Where a time stands among the instants: the one before, and the part of the way to the next. */
function place(times, time) {
  let [low, high] = [0, times.length - 1];
  if (high === 0 || time <= times[0]) return [0, 0];
  if (time >= times[high]) return [high - 1, 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return [low, (time - times[low]) / (times[high] - times[low])];
}

/** `count` values at a place among instants; written to `into`. */
function between(values, count, [k, part], into) {
  const [a, b] = [k * count, (k + 1) * count];
  if (part === 0) for (let i = 0; i < count; i++) into[i] = values[a + i];
  else for (let i = 0; i < count; i++) into[i] = values[a + i] + part * (values[b + i] - values[a + i]);
  return into;
}

/** A surface whose normals jump at sharp edges only. */
function creased(vertices, triangles) {
  const corner = (i) => new THREE.Vector3().fromArray(vertices, 3 * triangles[i]);
  const key = (v) => v.toArray().map((x) => Math.round(1e4 * x)).join();
  const faces = [];
  const around = new Map();
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [corner(i), corner(i + 1), corner(i + 2)];
    const face = b.clone().sub(a).cross(c.clone().sub(a));
    faces.push({ corners: [a, b, c], area: face.clone(), unit: face.normalize() });
    for (const v of [a, b, c]) around.set(key(v), [...(around.get(key(v)) || []), faces.length - 1]);
  }
  const [places, normals] = [[], []];
  for (const face of faces) {
    for (const v of face.corners) {
      const sum = new THREE.Vector3();
      for (const f of around.get(key(v))) if (faces[f].unit.dot(face.unit) > SHARP) sum.add(faces[f].area);
      places.push(...v.toArray());
      normals.push(...sum.normalize().toArray());
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(new Float32Array(normals), 3));
  return geometry;
}

/** Rings across a cube from −1 to 1 that hint at the layers of a muscle. */
function layers(count) {
  const points = [];
  const square = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
  for (let i = 1; i < count; i++) {
    const z = (2 * i) / count - 1;
    square.forEach(([x, y], s) => points.push(x, y, z, ...square[(s + 1) % 4], z));
  }
  const geometry = new THREE.BufferGeometry();
  return geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(points), 3));
}

const line = (colour, opacity) => new THREE.LineBasicMaterial({ color: colour, transparent: opacity < 1, opacity });

/** A body or a lumped muscle: a solid whose columns (three directions, a place) move. */
class Solid {
  constructor(part) {
    this.part = part;
    this.motion = numbers(part.motion);
    this.values = read(part.quantities);
    this.now = new Float32Array(12);
    this.held = new Float32Array(1);
    const is = part.kind === "body";
    const surface = is ? creased(numbers(part.vertices), indices(part.triangles)) : new THREE.BoxBufferGeometry(2, 2, 2);
    this.material = new THREE.MeshLambertMaterial({
      color: NEUTRAL[part.kind], transparent: is, opacity: is ? 0.22 : 1, depthWrite: !is,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    this.object = new THREE.Group();
    this.object.add(new THREE.Mesh(surface, this.material));
    // Bodies are glass: the wall behind is drawn before the one in front.
    if (is) {
      const behind = new THREE.Mesh(surface, Object.assign(this.material.clone(), { side: THREE.BackSide, opacity: 0.35 }));
      behind.renderOrder = -1;
      this.object.add(behind);
    }
    this.object.add(new THREE.LineSegments(new THREE.EdgesGeometry(surface, 35), line(is ? "#3c5570" : "#5a4632", is ? 0.8 : 0.7)));
    if (!is) this.object.add(new THREE.LineSegments(layers(12), line("#5a4632", 0.3)));
    this.object.matrixAutoUpdate = false;
    surface.computeBoundingBox();
    this.box = surface.boundingBox;
  }

  /** Corners of its box at instant k. */
  extent(k) {
    const m = this.matrix(this.motion.subarray(12 * k, 12 * k + 12));
    const { min, max } = this.box;
    const corners = [];
    if (!(max.x >= min.x)) return corners;
    for (let i = 0; i < 8; i++) {
      const corner = new THREE.Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z);
      corners.push(...corner.applyMatrix4(m).toArray());
    }
    return corners;
  }

  matrix(m, into = new THREE.Matrix4()) {
    return into.set(m[0], m[3], m[6], m[9], m[1], m[4], m[7], m[10], m[2], m[5], m[8], m[11], 0, 0, 0, 1);
  }

  move(at) {
    this.matrix(between(this.motion, 12, at, this.now), this.object.matrix);
    this.object.matrixWorldNeedsUpdate = true;
  }

  colour(quantity, at, scale) {
    const values = this.values[quantity];
    if (!values) this.material.color.set(NEUTRAL[this.part.kind]);
    else this.material.color.fromArray(TABLE, scale(between(values, 1, at, this.held)[0]));
  }

  /** The part at an instant as a ghost. */
  copy(at, opacity) {
    const copy = this.object.clone();
    this.matrix(between(this.motion, 12, at, new Float32Array(12)), copy.matrix);
    copy.children.forEach((child) => { child.material = faded(child.material, opacity); });
    return copy;
  }
}

/** An elastic block or membrane: faces of four corners that move. Each face has corners of its own, so that it is flat in the light. */
class Block {
  constructor(part) {
    this.part = part;
    this.reference = numbers(part.vertices);
    this.places = numbers(part.places);
    this.values = read(part.quantities);
    this.values.displacement = this.displacements();
    this.faces = indices(part.faces);
    this.now = new Float32Array(this.reference);
    this.held = new Float32Array(this.reference.length / 3);
    this.neutral = new THREE.Color(NEUTRAL.block).toArray();
    const corners = () => new THREE.BufferAttribute(new Float32Array(3 * this.faces.length), 3);
    this.surface = new THREE.BufferGeometry();
    this.surface.setAttribute("position", corners());
    this.surface.setAttribute("normal", corners());
    this.surface.setAttribute("color", corners());
    const halves = new Uint32Array(1.5 * this.faces.length);
    for (let f = 0; 6 * f < halves.length; f++) halves.set([0, 1, 2, 0, 2, 3].map((corner) => 4 * f + corner), 6 * f);
    this.surface.setIndex(new THREE.BufferAttribute(halves, 1));
    this.material = new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.position = new THREE.BufferAttribute(this.now, 3);
    this.object = new THREE.Group();
    this.object.add(new THREE.Mesh(this.surface, this.material));
    this.object.add(new THREE.LineSegments(this.lines(part.edges, this.position), line("#3a332a", 0.9)));
    this.object.add(new THREE.LineSegments(this.lines(part.inner, this.position), line("#3a332a", 0.22)));
    // Corners move out of the sphere in which three.js would look for them.
    this.object.children.forEach((child) => { child.frustumCulled = false; });
  }

  lines(ends, position) {
    const made = new THREE.BufferGeometry().setAttribute("position", position);
    made.setIndex(new THREE.BufferAttribute(indices(ends), 1));
    return made;
  }

  /** Edges of the reference configuration. */
  outline() {
    return new THREE.LineSegments(this.lines(this.part.edges, new THREE.BufferAttribute(this.reference, 3)), line("#8a9098", 1));
  }

  displacements() {
    const count = this.reference.length / 3;
    return Float32Array.from({ length: this.places.length / 3 }, (_, i) => {
      const far = [0, 1, 2].map((a) => this.places[3 * i + a] - this.reference[3 * (i % count) + a]);
      return Math.hypot(...far);
    });
  }

  extent(k) {
    return this.places.subarray(k * this.reference.length, (k + 1) * this.reference.length);
  }

  move(at) {
    between(this.places, this.now.length, at, this.now);
    this.position.needsUpdate = true;
    this.form(this.now, this.surface.attributes);
  }

  /** Corners and normals of the faces of a surface whose corners are at `places`. */
  form(places, { position, normal }) {
    const [p, n] = [position.array, normal.array];
    for (let i = 0; i < this.faces.length; i++) {
      const from = 3 * this.faces[i];
      for (let a = 0; a < 3; a++) p[3 * i + a] = places[from + a];
    }
    for (let f = 0; f < p.length; f += 12) {
      // Of both diagonals.
      const ax = p[f + 6] - p[f], ay = p[f + 7] - p[f + 1], az = p[f + 8] - p[f + 2];
      const bx = p[f + 9] - p[f + 3], by = p[f + 10] - p[f + 4], bz = p[f + 11] - p[f + 5];
      for (let i = f; i < f + 12; i += 3) {
        n[i] = ay * bz - az * by;
        n[i + 1] = az * bx - ax * bz;
        n[i + 2] = ax * by - ay * bx;
      }
    }
    position.needsUpdate = true;
    normal.needsUpdate = true;
  }

  colour(quantity, at, scale) {
    const values = this.values[quantity];
    const { color } = this.surface.attributes;
    if (values) between(values, this.held.length, at, this.held);
    for (let i = 0; i < this.faces.length; i++) {
      const from = values ? scale(this.held[this.faces[i]]) : 0;
      for (let c = 0; c < 3; c++) color.array[3 * i + c] = values ? TABLE[from + c] : this.neutral[c];
    }
    color.needsUpdate = true;
  }

  copy(at, opacity) {
    const moved = between(this.places, this.now.length, at, new Float32Array(this.now.length));
    const copy = this.object.clone();
    copy.children.forEach((child) => {
      child.geometry = child.geometry.clone();
      child.material = faded(child.material, opacity);
      child.frustumCulled = false;
      if (child.isMesh) this.form(moved, child.geometry.attributes);
      else child.geometry.setAttribute("position", new THREE.BufferAttribute(moved, 3));
    });
    return copy;
  }
}

function faded(material, opacity) {
  const copy = material.clone();
  return Object.assign(copy, { transparent: true, opacity: opacity * material.opacity, depthWrite: false });
}

function read(quantities = {}) {
  return Object.fromEntries(Object.entries(quantities).map(([name, text]) => [name, numbers(text)]));
}
