// Time: played, paused, moved by hand; everything that moves listens to it.

/** The clock of a motion from `first` to `last` in s. */
class Clock {
  constructor(first, last) {
    Object.assign(this, { first, last, time: first, speed: 1, playing: false, listeners: [] });
    // A motion is shown in 4 s or more, unless the reader wants it faster.
    this.rate = Math.min(1, (last - first) / 4) || 1;
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
  const slider = element("input", { type: "range", id: "time", min: 0, max: steps, step: 1, "aria-label": "Time" });
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
    slider.setAttribute("aria-valuetext", `${time.toFixed(digits)} s`);
    told.textContent = `${time.toFixed(digits)} of ${clock.last.toFixed(digits)} s`;
  });
}
