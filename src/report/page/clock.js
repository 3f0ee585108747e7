// Time: played, paused, moved by hand; everything that moves listens to it.

/** The clock of a motion from `first` to `last` in s, or of a path of equilibria by their numbers, which have `fractions` of the voltages. */
class Clock {
  constructor(first, last, fractions = null) {
    Object.assign(this, { first, last, fractions, time: first, speed: 1, playing: false, listeners: [] });
    // A motion is shown in 4 s or more, unless the reader wants it faster; a path in 6 s.
    this.rate = fractions ? (last - first) / 6 : Math.min(1, (last - first) / 4) || 1;
  }

  /** Fraction of the voltages at a place of the path. */
  fraction(time = this.time) {
    const before = Math.min(Math.max(0, this.fractions.length - 2), Math.floor(time));
    const [a, b] = [this.fractions[before], this.fractions[Math.min(before + 1, this.fractions.length - 1)]];
    return a + (time - before) * (b - a);
  }

  /** The time in words, with so many digits. */
  told(time, digits) {
    if (this.fractions) return `${(100 * this.fraction(time)).toFixed(2)} % of the voltages`;
    return `${time.toFixed(digits)} of ${this.last.toFixed(digits)} s`;
  }

  /** Calls `listener(time)` whenever the time changes, and now. */
  listen(listener) {
    this.listeners.push(listener);
    listener(this.time);
  }

  set(time) {
    this.time = Math.min(this.last, Math.max(this.first, time));
    for (const listener of this.listeners) listener(this.time);
  }

  play(on) {
    if (on === this.playing) return;
    this.playing = on;
    if (on && this.time >= this.last) this.set(this.first);
    let before = null;
    const step = (now) => {
      if (!this.playing) return;
      if (before !== null) {
        const time = this.time + ((now - before) / 1000) * this.rate * this.speed;
        this.set(time > this.last ? this.first : time);
      }
      before = now;
      requestAnimationFrame(step);
    };
    if (on) requestAnimationFrame(step);
    this.changed?.();
  }
}

/** Play, slider, speed. */
function player(clock, bar) {
  const play = element("button", { id: "play", onclick: () => clock.play(!clock.playing) }, "Play");
  clock.changed = () => { play.textContent = clock.playing ? "Pause" : "Play"; };
  const steps = 1000;
  const slider = element("input", { type: "range", id: "time", min: 0, max: steps, step: 1, "aria-label": clock.fractions ? "Equilibrium" : "Time" });
  slider.addEventListener("input", () => {
    clock.play(false);
    clock.set(clock.first + ((clock.last - clock.first) * slider.value) / steps);
  });
  const told = element("output", { for: "time" });
  const speeds = [0.1, 0.25, 0.5, 1, 2, 4].map((s) => element("option", { value: s }, `${s} ×`));
  const speed = element("select", { id: "speed", "aria-label": "Speed" }, ...speeds);
  speed.value = "1";
  speed.addEventListener("change", () => { clock.speed = Number(speed.value); });
  bar.append(play, slider, told, element("label", {}, "speed", speed));
  const digits = Math.max(0, Math.ceil(-Math.log10((clock.last - clock.first) / 500)));
  clock.listen((time) => {
    slider.value = Math.round((steps * (time - clock.first)) / (clock.last - clock.first));
    told.textContent = clock.told(time, digits);
    slider.setAttribute("aria-valuetext", told.textContent);
  });
}
