// The picture of the scene: drawn when something has changed, finely at rest, and while it moves as finely as drawing is fast.

/** Milliseconds that drawing may take while the scene moves. */
const BUDGET = 5;
/** Pixels along a px of the page: at least, and at rest, where several pixels make one of the screen in place of smoothed edges. */
const RESOLUTION = [0.5, 2, 3];
/** Milliseconds without a change after which the scene is at rest. */
const REST = 200;

class Picture {
  /** A canvas that shows `root`, as the camera `three` sees it. */
  constructor(canvas, root, three) {
    Object.assign(this, { root, three, changed: -Infinity, asked: false });
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: false, alpha: false, stencil: false });
    const [, least, most] = RESOLUTION;
    this.finest = Math.min(most, Math.max(least, 2 * window.devicePixelRatio || least));
    this.coarse = this.finest;
    this.renderer.setPixelRatio(this.finest);
    this.theme();
  }

  /** The paper of the page. */
  theme() {
    this.renderer.setClearColor(themed("panel"));
  }

  /** Width and height in px of the page. */
  resize(width, height) {
    this.renderer.setSize(width, height, false);
  }

  /** Draws with the next picture of the browser. */
  ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame((now) => {
      this.asked = false;
      const moves = now - this.changed < REST;
      if (moves) this.draw(this.coarse);
      else this.measure();
      // The time that drawing takes is no rest.
      this.changed = performance.now();
    });
  }

  /** Another picture takes its place. */
  leave() {
    clearTimeout(this.rest);
    this.asked = true;
    this.draw = this.measure = () => {};
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  draw(resolution) {
    clearTimeout(this.rest);
    if (this.renderer.getPixelRatio() !== resolution) this.renderer.setPixelRatio(resolution);
    this.renderer.render(this.root, this.three);
    if (resolution !== this.finest) this.rest = setTimeout(() => this.draw(this.finest), REST);
  }

  /** Draws finely, and from the time that this takes tells how finely it may be drawn while it moves. */
  measure() {
    const gl = this.renderer.getContext();
    const began = performance.now();
    this.draw(this.finest);
    // Only a pixel that is read was drawn.
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    const part = Math.sqrt(BUDGET / (performance.now() - began));
    this.coarse = Math.min(this.finest, Math.max(RESOLUTION[0], this.finest * part));
  }
}
