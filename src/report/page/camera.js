// A parallel view of the scene as it stands: turned, moved and enlarged by pointer and keys.

/** Part of the picture that is left free around the motion. */
const MARGIN = 0.06;
/** Least and greatest enlargement. */
const ZOOM = [0.2, 60];

class Camera {
  /**
   * A camera that frames `points` (x, y, z, x, …) as seen from the direction `toward`; `changed()` asks for a picture. Directions are in a frame
   * with y upwards, whose axes in the ground frame `upright` lists.
   */
  constructor(points, { toward, upright }, changed) {
    Object.assign(this, { points, auto: toward, upright, changed, aspect: 1 });
    this.three = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 10);
    this.look("auto");
  }

  /** Looks from a named direction and frames everything. */
  look(name) {
    const sides = { front: [0, 0, 1], side: [1, 0, 0], top: [0, 1, 0] };
    const [x, y, z] = sides[name] || this.auto;
    this.azimuth = Math.hypot(x, z) > 1e-9 ? Math.atan2(x, z) : 0;
    this.elevation = Math.atan2(y, Math.hypot(x, z));
    this.frame();
  }

  axes() {
    const [sa, ca, se, ce] = [Math.sin(this.azimuth), Math.cos(this.azimuth), Math.sin(this.elevation), Math.cos(this.elevation)];
    const stands = (v) => [0, 1, 2].map((i) => v.reduce((sum, x, a) => sum + x * this.upright[3 * a + i], 0));
    return { right: stands([ca, 0, -sa]), up: stands([-sa * se, ce, -ca * se]), toward: stands([sa * ce, se, ca * ce]) };
  }

  /** Extent of all points along right, up and toward. */
  extent() {
    const { right, up, toward } = this.axes();
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    const p = this.points;
    for (let i = 0; i < p.length; i += 3) {
      [right, up, toward].forEach((axis, a) => {
        const at = axis[0] * p[i] + axis[1] * p[i + 1] + axis[2] * p[i + 2];
        if (at < low[a]) low[a] = at;
        if (at > high[a]) high[a] = at;
      });
    }
    return p.length ? { low, high } : { low: [-1, -1, -1], high: [1, 1, 1] };
  }

  /** Frames all points. */
  frame() {
    const { low, high } = this.extent();
    this.middle = low.map((l, a) => (l + high[a]) / 2);
    this.half = low.map((l, a) => Math.max((high[a] - l) / 2, 1e-3));
    this.zoom = 1;
    this.shift = [0, 0];
    this.update();
  }

  /** Height of half the picture in mm. */
  height() {
    const [width, height] = this.half;
    return ((1 + 2 * MARGIN) * Math.max(height, width / this.aspect)) / this.zoom;
  }

  update() {
    const { right, up, toward } = this.axes();
    const along = [this.middle[0] + this.shift[0], this.middle[1] + this.shift[1], this.middle[2]];
    const centre = [0, 1, 2].map((i) => right[i] * along[0] + up[i] * along[1] + toward[i] * along[2]);
    const far = 20 * Math.hypot(...this.half);
    const basis = new THREE.Matrix4().makeBasis(...[right, up, toward].map((axis) => new THREE.Vector3(...axis)));
    const height = this.height();
    const width = height * this.aspect;
    this.three.quaternion.setFromRotationMatrix(basis);
    this.three.position.set(...centre.map((c, i) => c + (far / 2) * toward[i]));
    Object.assign(this.three, { left: -width, right: width, top: height, bottom: -height, near: 0, far });
    this.three.updateProjectionMatrix();
    this.three.updateMatrixWorld();
    this.changed();
  }

  resize(aspect) {
    this.aspect = aspect;
    this.update();
  }

  turn(azimuth, elevation) {
    // The middle stays where it is.
    const { right, up, toward } = this.axes();
    const along = [this.middle[0] + this.shift[0], this.middle[1] + this.shift[1], this.middle[2]];
    const centre = [0, 1, 2].map((i) => right[i] * along[0] + up[i] * along[1] + toward[i] * along[2]);
    this.azimuth += azimuth;
    this.elevation = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.elevation + elevation));
    const turned = this.axes();
    this.middle = [turned.right, turned.up, turned.toward].map((axis) => axis.reduce((sum, a, i) => sum + a * centre[i], 0));
    this.shift = [0, 0];
    this.update();
  }

  enlarge(factor) {
    this.zoom = Math.min(ZOOM[1], Math.max(ZOOM[0], this.zoom * factor));
    this.update();
  }

  /** Moves the picture by parts of its height. */
  move(right, up) {
    this.shift[0] -= 2 * this.height() * right;
    this.shift[1] -= 2 * this.height() * up;
    this.update();
  }
}

/** Pointer and keys on a canvas: one finger or the left button turns, two fingers or the right button move, pinch and wheel enlarge. */
function steer(camera, canvas) {
  const fingers = new Map();
  const size = () => canvas.clientHeight;
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY, moves: event.button === 2 || event.shiftKey });
  });
  canvas.addEventListener("pointermove", (event) => {
    const finger = fingers.get(event.pointerId);
    if (!finger) return;
    const [dx, dy] = [(event.clientX - finger.x) / size(), (event.clientY - finger.y) / size()];
    const before = fingers.size === 2 ? spread() : 0;
    Object.assign(finger, { x: event.clientX, y: event.clientY });
    if (fingers.size === 2) {
      camera.enlarge(spread() / before);
      camera.move(dx / 2, -dy / 2);
    } else if (finger.moves) camera.move(dx, -dy);
    else camera.turn(-3 * dx, 3 * dy);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  // The wheel scrolls the page unless the reader has chosen the scene.
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    camera.enlarge(Math.exp(-0.0015 * event.deltaY));
  }, { passive: false });
  const keys = {
    ArrowLeft: () => camera.turn(-0.1, 0),
    ArrowRight: () => camera.turn(0.1, 0),
    ArrowUp: () => camera.turn(0, 0.1),
    ArrowDown: () => camera.turn(0, -0.1),
    "+": () => camera.enlarge(1.15),
    "-": () => camera.enlarge(1 / 1.15),
    0: () => camera.frame(),
  };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key]();
  });
}
