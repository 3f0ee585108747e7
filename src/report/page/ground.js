// What the robot stands on and how it lies: the ground, axes and a scale in a corner of the picture.

const GROUND = "#8d949c";
/** Colours of x, y and z, as of the frames of bodies. */
const AXES = ["#d02f2f", "#2c9a3f", "#2f6fd0"];

/** The plate below all that the ground holds, and faces of elastic blocks that it holds; none where it holds nothing. */
function ground({ plate, faces }) {
  const group = new THREE.Group();
  const material = () => new THREE.MeshLambertMaterial({ color: GROUND, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 });
  const surface = (places, triangles) => {
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(places, 3));
    made.setIndex(triangles);
    made.computeVertexNormals();
    return made;
  };
  const rim = numbers(plate);
  const count = rim.length / 3;
  if (count) {
    // A fan around its first corner.
    const triangles = Array.from({ length: count - 2 }, (_, i) => [0, i + 2, i + 1]).flat();
    const disc = new THREE.Mesh(surface(rim, triangles), Object.assign(material(), { transparent: true, opacity: 0.45, depthWrite: false }));
    disc.renderOrder = -2;
    const edge = new THREE.BufferGeometry().setAttribute("position", disc.geometry.attributes.position);
    group.add(disc, new THREE.LineLoop(edge, line(GROUND, 1)));
  }
  const corners = numbers(faces);
  if (corners.length) {
    const triangles = Array.from({ length: corners.length / 12 }, (_, f) => [0, 1, 2, 0, 2, 3].map((corner) => 4 * f + corner)).flat();
    group.add(new THREE.Mesh(surface(corners, triangles), material()));
  }
  return group.children.length ? group : null;
}

/** Axes of the ground frame as the camera sees them, and a bar of a round length. */
class Gauge {
  constructor(camera, holder) {
    Object.assign(this, { camera, holder });
    this.drawing = drawn("svg", { id: "gauge", viewBox: "0 0 150 104", role: "img" });
    holder.append(this.drawing);
    this.draw();
  }

  draw() {
    const { right, up, toward } = this.camera.axes();
    const [length, label] = this.bar();
    this.drawing.replaceChildren();
    this.drawing.setAttribute("aria-label", `Axes of the ground frame; a bar of ${label}`);
    const [x, y] = [34, 48];
    const axes = AXES.map((colour, i) => ({ colour, name: "xyz"[i], along: [right[i], -up[i]], depth: toward[i] }));
    // What points towards the reader lies above the others.
    for (const { colour, name, along, depth } of axes.sort((a, b) => a.depth - b.depth)) {
      const at = (part) => [x + part * along[0], y + part * along[1]];
      const [end, text] = [at(26), at(36)];
      if (Math.hypot(...along) < 0.1) {
        this.drawing.append(drawn("circle", { cx: x, cy: y, r: 3, fill: colour }));
        Object.assign(text, [x - 9, y + 9]);
      } else this.drawing.append(drawn("line", { x1: x, y1: y, x2: end[0], y2: end[1], stroke: colour, "stroke-width": 2 }));
      this.drawing.append(drawn("text", { x: text[0], y: text[1] + 4, "text-anchor": "middle" }, name));
    }
    const [left, bottom] = [8, 96];
    this.drawing.append(drawn("path", { d: `M${left} ${bottom - 5}V${bottom}H${left + length}V${bottom - 5}` }));
    this.drawing.append(drawn("text", { x: left + length + 6, y: bottom + 1 }, label));
  }

  /** Length of the bar in px of the page, and what it stands for. */
  bar() {
    const perMillimetre = this.holder.clientHeight / (2 * this.camera.height()) || 1;
    const most = 84 / perMillimetre;
    const size = 10 ** Math.floor(Math.log10(most));
    const length = [5, 2, 1].map((digit) => digit * size).find((one) => one <= most) ?? size;
    const [value, unit] = length >= 1000 ? [length / 1000, "m"] : length < 0.1 ? [1000 * length, "µm"] : [length, "mm"];
    return [length * perMillimetre, `${short(value)} ${unit}`];
  }
}
