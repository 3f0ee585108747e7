// The robot in space: parts, paths, goal, and what the reader asks for besides.

/** Quantities that colour parts: what they are called, their units, whether their scale begins at zero. */
const QUANTITIES = {
  voltage: { name: "voltage", unit: "kV", zero: true },
  stretch: { name: "stretch", unit: "", zero: false },
  field: { name: "true electric field", unit: "MV/m", zero: true },
  stress: { name: "von Mises stress", unit: "kPa", zero: true },
  displacement: { name: "displacement", unit: "mm", zero: true },
};
/** Colours of the motion that is compared, of what markers were to follow, and of what was asked for at the end. */
const [BESIDE, ASKED, GOAL] = ["#8a9098", "#b8860b", "#009e73"];
/** Most markers that are named. */
const NAMED = 12;
/** Poses of a still of the motion. */
const SNAPSHOTS = 6;

class Scene {
  constructor(data, holder) {
    Object.assign(this, { data, holder, times: numbers(data.times), root: new THREE.Scene() });
    this.canvas = element("canvas", { tabindex: 0, role: "application", "aria-label": "The robot in space. Arrow keys turn it, plus and minus enlarge it, zero shows all of it." });
    holder.append(this.canvas);
    /** Whether states of rest are shown, which the reference configuration stands beside. */
    this.rests = this.times.length === 1 || Boolean(data.branch);
    this.parts = data.parts.map((part) => (part.kind === "block" ? new Block(part) : new Solid(part)));
    this.root.add(...this.parts.map((part) => part.object));
    this.markers = data.markers.map((marker) => ({
      ...marker, times: numbers(marker.times), path: numbers(marker.path), target: marker.target ? numbers(marker.target) : [],
      compared: marker.compared && numbers(marker.compared), followed: marker.followed && numbers(marker.followed),
    }));
    const points = this.extent();
    this.camera = new Camera(points, data, () => {
      this.gauge?.draw();
      this.draw();
    });
    this.picture = new Picture(this.canvas, this.root, this.camera.three);
    this.size = 2 * Math.hypot(...this.camera.half);
    this.gauge = new Gauge(this.camera, holder);
    this.light();
    this.groups = { ground: ground(data.ground), paths: this.paths(), joints: this.joints(), axes: this.jointAxes(), frames: this.frames(), goal: this.goal(), reference: this.reference(), snapshots: new THREE.Group() };
    this.ties();
    for (const group of Object.values(this.groups)) if (group) this.root.add(group);
    for (const name of ["axes", "frames", "snapshots"]) if (this.groups[name]) this.groups[name].visible = false;
    steer(this.camera, this.canvas);
    this.resized = new ResizeObserver(() => this.resize());
    this.resized.observe(holder);
    this.resize();
    this.ranges = this.scales();
    this.quantity = Object.keys(this.ranges)[0];
    this.set(this.times[0]);
  }

  /** What moves besides the parts. */
  movers = [];

  /** Places that the picture has to hold: parts at all instants, paths of markers. */
  extent() {
    const all = [];
    const push = (values) => { for (const value of values) if (Number.isFinite(value)) all.push(value); };
    if (this.rests) for (const part of this.parts) push(part.reference || []);
    for (let k = 0; k < this.times.length; k++) for (const part of this.parts) push(part.extent(k));
    for (const marker of this.markers) push([...marker.path, ...marker.target]);
    for (const tie of this.data.ties) push(numbers(tie.places));
    push(numbers(this.data.ground.plate));
    return new Float32Array(all);
  }

  light() {
    const from = (x, y, z, strength) => {
      const light = new THREE.DirectionalLight(0xffffff, strength);
      light.position.set(x, y, z);
      this.camera.three.add(light);
    };
    this.root.add(this.camera.three, new THREE.AmbientLight(0xffffff, 0.62));
    from(-0.7, 0.9, 1, 0.42);
    from(0.8, -0.3, 0.6, 0.14);
  }

  /** A tube through places. */
  tube(values, colour, width, opacity = 1) {
    const points = [];
    const stride = Math.max(1, Math.floor(values.length / 3 / 300));
    for (let i = 0; i < values.length; i += 3 * stride) {
      const point = new THREE.Vector3().fromArray(values, i);
      if (!points.length || point.distanceTo(points[points.length - 1]) > 1e-5 * this.size) points.push(point);
    }
    points.push(new THREE.Vector3().fromArray(values, values.length - 3));
    if (points.length < 3) return new THREE.Group();
    const curve = new THREE.CatmullRomCurve3(points);
    const geometry = new THREE.TubeBufferGeometry(curve, Math.min(600, 2 * points.length), width * this.size, 6);
    return new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: colour, transparent: opacity < 1, opacity }));
  }

  ball(colour, radius) {
    return new THREE.Mesh(new THREE.SphereBufferGeometry(radius * this.size, 16, 12), new THREE.MeshLambertMaterial({ color: colour }));
  }

  paths() {
    const group = new THREE.Group();
    for (const marker of this.markers) {
      if (marker.compared) group.add(this.tube(marker.compared, BESIDE, 0.0011, 0.8));
      if (marker.followed) group.add(this.tube(marker.followed, ASKED, 0.0016));
      group.add(this.tube(marker.path, marker.colour, 0.0022));
      const ball = this.ball(marker.colour, 0.008);
      group.add(ball);
      const now = new Float32Array(3);
      this.movers.push((_, time) => {
        const at = marker.times.length > 1 ? place(marker.times, time ?? marker.times[0]) : [0, 0];
        ball.position.fromArray(between(marker.path, 3, at, now));
      });
    }
    return group;
  }

  /** Lines whose ends move: `ends(at)` gives their places. */
  moving(count, colour, ends) {
    const places = new THREE.BufferAttribute(new Float32Array(6 * count), 3);
    const lines = new THREE.LineSegments(new THREE.BufferGeometry().setAttribute("position", places), line(colour, 1));
    lines.frustumCulled = false;
    this.movers.push((at) => {
      if (lines.parent && !lines.parent.visible) return;
      ends(at, places.array);
      places.needsUpdate = true;
    });
    return lines;
  }

  ties() {
    for (const tie of this.data.ties) {
      const all = numbers(tie.places);
      const now = new Float32Array(3 * tie.count);
      const lines = this.moving(tie.count - 1, tie.colour, (at, into) => {
        between(all, now.length, at, now);
        for (let i = 0; i + 1 < tie.count; i++) into.set(now.subarray(3 * i, 3 * i + 6), 6 * i);
      });
      this.root.add(lines);
    }
  }

  joints() {
    const group = new THREE.Group();
    const bodies = this.parts.filter((part) => part.part.kind === "body");
    for (const joint of this.data.joints) {
      const all = numbers(joint.places);
      const now = new Float32Array(3);
      const ball = this.ball("#e9edf2", 0.007);
      group.add(ball);
      this.movers.push((at) => ball.position.fromArray(between(all, 3, at, now)));
      for (const b of joint.bodies.filter((body) => body !== null)) {
        group.add(this.moving(1, "#55606c", (at, into) => {
          between(all, 3, at, into);
          for (let i = 0; i < 3; i++) into[3 + i] = bodies[b].now[9 + i];
        }));
      }
    }
    return group;
  }

  jointAxes() {
    const joints = this.data.joints.filter((joint) => joint.axis);
    if (!joints.length) return null;
    const group = new THREE.Group();
    for (const joint of joints) {
      const [all, axis] = [numbers(joint.places), numbers(joint.axis)];
      const [a, b] = [new Float32Array(3), new Float32Array(3)];
      group.add(this.moving(1, "#d55e00", (at, into) => {
        between(all, 3, at, a);
        between(axis, 3, at, b);
        const half = (0.08 * this.size) / Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        for (let i = 0; i < 3; i++) {
          into[i] = a[i] - half * (b[i] - a[i]);
          into[3 + i] = a[i] + half * (b[i] - a[i]);
        }
      }));
    }
    return group;
  }

  /** Directors of the bodies: red, green and blue. */
  frames() {
    const bodies = this.parts.filter((part) => part.part.kind === "body");
    if (!bodies.length) return null;
    const group = new THREE.Group();
    for (const body of bodies) {
      ["#d02f2f", "#2c9a3f", "#2f6fd0"].forEach((colour, i) => {
        group.add(this.moving(1, colour, (_, into) => {
          const m = body.now;
          for (let a = 0; a < 3; a++) {
            into[a] = m[9 + a];
            into[3 + a] = m[9 + a] + 0.07 * this.size * m[3 * i + a];
          }
        }));
      });
    }
    return group;
  }

  /** Bodies as ghosts where they were to end, crosses where markers were. */
  goal() {
    const group = new THREE.Group();
    const all = this.data.goal ? numbers(this.data.goal) : [];
    this.parts.filter((part) => all.length && part.part.kind === "body").forEach((body, b) => {
      const ghost = body.copy([0, 0], 0.55);
      body.matrix(all.subarray(12 * b, 12 * b + 12), ghost.matrix);
      ghost.children.forEach((child) => child.material.color.set(GOAL));
      group.add(ghost);
    });
    const [long, thin] = [0.05 * this.size, 0.003 * this.size];
    // Seen through what is before them.
    const material = new THREE.MeshBasicMaterial({ color: GOAL, depthTest: false, transparent: true, opacity: 0.85 });
    for (const { target } of this.markers.filter((marker) => marker.target.length)) {
      for (let at = 0; at < target.length; at += 3) {
        for (let i = 0; i < 3; i++) {
          const arm = new THREE.Mesh(new THREE.BoxBufferGeometry(...[0, 1, 2].map((j) => (i === j ? long : thin))), material);
          arm.position.fromArray(target, at);
          arm.renderOrder = 1;
          group.add(arm);
        }
      }
    }
    group.visible = !this.data.goal;
    return group.children.length ? group : null;
  }

  /** Edges of elastic blocks where nothing deforms them; shown from the beginning beside a state of rest. */
  reference() {
    const blocks = this.parts.filter((part) => part.outline);
    if (!blocks.length) return null;
    const group = new THREE.Group();
    group.add(...blocks.map((block) => block.outline()));
    group.visible = this.rests;
    return group;
  }

  /** Poses of the motion at equal distances of time, made when they are asked for first. */
  snapshots() {
    const group = this.groups.snapshots;
    if (group.children.length) return;
    const [first, last] = [this.times[0], this.times[this.times.length - 1]];
    for (let i = 0; i < SNAPSHOTS; i++) {
      const at = place(this.times, first + ((last - first) * i) / (SNAPSHOTS - 1));
      for (const part of this.parts) {
        part.colour(this.quantity, at, this.scale());
        group.add(part.copy(at, 0.5));
      }
    }
    this.set(this.time);
  }

  /** Names and colours of what is not seen to be itself: of lines or of surfaces, and the group that they belong to. */
  named() {
    const [motion, beside] = this.data.names;
    const named = [];
    const several = this.markers.some((marker) => marker.compared);
    if (this.markers.length <= NAMED) for (const { name, colour } of this.markers) named.push({ name: several ? `${name}, ${motion}` : name, colour, group: "paths" });
    if (several) named.push({ name: beside, colour: BESIDE, group: "paths" });
    if (this.markers.some((marker) => marker.followed)) named.push({ name: "reference", colour: ASKED, group: "paths" });
    named.push({ name: "goal", colour: GOAL, group: "goal", solid: true }, { name: "reference configuration", colour: BESIDE, group: "reference" }, { name: "ground", colour: GROUND, group: "ground", solid: true });
    return named.filter(({ group }) => this.groups[group]);
  }

  /** A picture of the scene on paper, which stays when the screen has gone. */
  still(canvas) {
    this.resize();
    const { renderer } = this.picture;
    renderer.setPixelRatio(PRINTED);
    renderer.render(this.root, this.camera.three);
    Object.assign(canvas, { width: renderer.domElement.width, height: renderer.domElement.height });
    canvas.getContext("2d").drawImage(renderer.domElement, 0, 0);
  }

  show(name, on) {
    if (name === "snapshots" && on) this.snapshots();
    this.groups[name].visible = on;
    this.set(this.time);
  }

  /** Least and greatest value of each quantity that some part has. */
  scales() {
    const ranges = {};
    for (const [name, { zero }] of Object.entries(QUANTITIES)) {
      let [low, high] = [Infinity, -Infinity];
      for (const part of this.parts) for (const v of part.values[name] || []) {
        if (v < low) low = v;
        if (v > high) high = v;
      }
      if (!(high >= low)) continue;
      if (name === "voltage") [low, high] = [0, this.data.voltage];
      if (zero) low = 0;
      if (high - low < 1e-9 * Math.max(1, Math.abs(high))) high = low + 1e-3 * Math.max(1, Math.abs(low));
      ranges[name] = [low, high];
    }
    return ranges;
  }

  /** Where the colour of a value of the quantity that is shown begins in the table. */
  scale() {
    const [low, high] = this.ranges[this.quantity] || [0, 1];
    return (value) => step((value - low) / (high - low));
  }

  paint(quantity) {
    this.quantity = quantity;
    this.groups.snapshots.children.splice(0);
    if (this.groups.snapshots.visible) this.snapshots();
    this.set(this.time);
  }

  set(time) {
    this.time = time;
    const at = place(this.times, time);
    const scale = this.scale();
    for (const part of this.parts) {
      part.move(at);
      part.colour(this.quantity, at, scale);
    }
    for (const mover of this.movers) mover(at, time);
    this.draw();
  }

  resize() {
    const [width, height] = [this.holder.clientWidth, this.holder.clientHeight];
    if (!width || !height) return;
    this.picture.resize(width, height);
    this.camera.resize(width / height);
  }

  draw() {
    this.picture?.ask();
  }

  /** Another motion is shown. */
  leave() {
    this.resized.disconnect();
    this.picture.leave();
  }
}

/** What the reader chooses: view, colours, what is shown besides. */
function options(scene, bar, holder) {
  const choice = (label, id, entries, chosen) => {
    const select = element("select", { id, "aria-label": label }, ...entries.map(([value, name]) => element("option", { value }, name)));
    select.addEventListener("change", () => chosen(select.value));
    bar.append(element("label", {}, label.toLowerCase(), select));
  };
  const names = Object.keys(scene.ranges);
  if (names.length) {
    const scale = element("div", { id: "scale" });
    holder.append(scale);
    const told = () => {
      const { name, unit } = QUANTITIES[scene.quantity];
      const [low, high] = scene.ranges[scene.quantity];
      const strip = element("canvas", { width: 150, height: 1, "aria-hidden": true });
      const pen = strip.getContext("2d");
      for (let i = 0; i < 150; i++) {
        pen.fillStyle = `rgb(${mapped(i / 149).map((c) => Math.round(255 * c)).join(",")})`;
        pen.fillRect(i, 0, 1, 1);
      }
      const ends = element("div", { class: "ends" }, element("span", {}, short(low, 3)), element("span", {}, short(high, 3)));
      scale.replaceChildren(element("div", {}, unit ? `${name} [${unit}]` : name), strip, ends);
    };
    choice("Colour", "colour", names.map((name) => [name, QUANTITIES[name].name]), (name) => {
      scene.paint(name);
      told();
    });
    told();
  }
  choice("View", "viewpoint", [["auto", "auto"], ["front", "front"], ["side", "side"], ["top", "top"]], (name) => scene.camera.look(name));
  const labels = { paths: scene.times.length > 1 ? "Paths" : "Markers", goal: "Goal", reference: "Reference", ground: "Ground", frames: "Frames", axes: "Joint axes", snapshots: "Snapshots" };
  const legend = element("ul", { id: "legend", "aria-label": "Legend" });
  const entries = scene.named().map(({ name, colour, group, solid }) => ({ group, entry: element("li", { class: solid ? "solid" : null, style: `--c:${colour}` }, name) }));
  const list = () => legend.replaceChildren(...entries.filter(({ group }) => scene.groups[group].visible).map(({ entry }) => entry));
  for (const [name, label] of Object.entries(labels)) {
    const group = scene.groups[name];
    if (!group || (name === "paths" && !group.children.length) || (name === "snapshots" && scene.times.length < 3)) continue;
    const button = element("button", { id: `show-${name}`, "aria-pressed": group.visible }, label);
    button.addEventListener("click", () => {
      scene.show(name, !group.visible);
      button.setAttribute("aria-pressed", group.visible);
      list();
    });
    bar.append(button);
  }
  list();
  holder.append(legend);
}
