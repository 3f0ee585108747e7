// Curves: panels with a cursor at the time of the scene, rows of colours where there are many.

/** Width of the labels at the left in px, the same everywhere so that time axes stand below each other. */
const LABELS = 66;
/** Pixels along a px of paper. */
const PRINTED = 3;

/** All charts of a page; those over time follow the clock, and a touch on them moves it. */
class Charts {
  constructor(charts, holder, clock) {
    Object.assign(this, { holder, clock, made: [], folded: [] });
    for (const chart of charts) this.section(chart);
  }

  renew() {
    for (const panel of this.made) panel.renew();
  }

  /** Another motion is shown. */
  leave() {
    for (const panel of this.made) panel.leave();
  }

  /** Draws all of them for paper, or those in sight for the screen again. */
  print(on) {
    // Names of many curves are told on paper too.
    if (on) this.folded = [...this.holder.querySelectorAll("details:not([open])")];
    for (const names of this.folded) names.open = on;
    for (const panel of this.made) panel.printed = on;
    this.renew();
  }

  section(chart) {
    const equal = chart.panels.every((panel) => panel.equal);
    const several = chart.kind !== "rows" && chart.panels.length > 1;
    const panels = element("div", { class: `panels ${chart.kind === "rows" ? "rows" : several ? "several" : "alone"} ${equal ? "equal" : ""}` });
    this.holder.append(element("section", { "aria-label": chart.title }, element("h2", {}, chart.title), panels));
    const clock = chart.time || chart.level ? this.clock : null;
    if (chart.kind === "sizes") panels.before(this.slider(chart));
    if (chart.kind === "rows") this.made.push(new Rows(chart, panels, clock));
    else for (const panel of chart.panels) this.made.push(new Panel(panel, panels, clock, chart));
  }

  /** A slider over the sizes of a disturbance, of which each was simulated. */
  slider({ title, sizes, shown }) {
    const told = element("output", { for: "size" });
    const slider = element("input", { type: "range", id: "size", min: 0, max: sizes.length - 1, step: 1, value: shown, "aria-label": "Size of the disturbance" });
    const tell = () => {
      told.textContent = `${short(sizes[slider.value])} of the disturbance`;
      slider.setAttribute("aria-valuetext", told.textContent);
    };
    slider.addEventListener("input", () => {
      tell();
      for (const panel of this.made) if (panel.title === title && panel.size !== undefined) panel.resize(Number(slider.value));
    });
    tell();
    return element("div", { class: "bar", role: "group", "aria-label": title }, slider, told);
  }
}

/** A chart that is drawn when it comes into sight. */
class Drawn {
  constructor(holder, clock, label, height) {
    Object.assign(this, { clock, visible: false, level: Boolean(clock?.fractions) });
    this.canvas = element("canvas", { role: "img", "aria-label": label });
    this.cursor = element("div", { class: "cursor" });
    this.plot = element("div", { class: "plot" }, this.canvas, this.cursor);
    if (height) this.plot.style.height = `${height}px`;
    holder.append(this.plot);
    this.sight = new IntersectionObserver(([entry]) => {
      this.visible = entry.isIntersecting;
      if (this.visible && !this.chart) this.renew();
      if (this.visible) this.follow();
    }, { rootMargin: "200px" });
    this.sight.observe(this.plot);
    this.cursor.classList.toggle("level", this.level);
    if (!clock) return;
    clock.listen(() => this.visible && this.follow());
    if (this.level) return;
    const pick = (event) => {
      if (event.type === "pointermove" && !event.buttons) return;
      clock.play(false);
      clock.set(this.chart.scales.x.getValueForPixel(event.offsetX));
    };
    this.canvas.addEventListener("pointerdown", pick);
    this.canvas.addEventListener("pointermove", pick);
  }

  leave() {
    this.sight.disconnect();
    this.chart?.destroy();
  }

  renew() {
    this.chart?.destroy();
    this.chart = null;
    this.cursor.style.display = "none";
    if (!this.visible && !this.printed) return;
    this.chart = new Chart(this.canvas, this.settings());
    this.follow();
  }

  follow() {
    if (!this.clock || !this.chart?.chartArea) return;
    const { top, bottom, left, right } = this.chart.chartArea;
    if (this.level) {
      const height = this.chart.scales.y.getPixelForValue(this.clock.fraction());
      Object.assign(this.cursor.style, { display: "block", left: `${left}px`, width: `${right - left}px`, transform: `translateY(${height}px)` });
      return;
    }
    const at = this.chart.scales.x.getPixelForValue(this.clock.time);
    Object.assign(this.cursor.style, { display: "block", top: `${top}px`, height: `${bottom - top}px`, transform: `translateX(${at}px)` });
    this.tell?.();
  }

  /** What all charts have in common. */
  common(x, y) {
    const axis = (title, log) => ({
      type: log ? "logarithmic" : "linear",
      title: { display: true, text: title, color: themed("ink") },
      grid: { color: themed("line"), borderColor: themed("muted") },
      ticks: { color: themed("muted"), maxRotation: 0, autoSkipPadding: 18, maxTicksLimit: log ? 8 : 11, includeBounds: false, callback: (value) => short(value, 5) },
    });
    const scales = { x: axis(x.label, x.log), y: axis(y.label, y.log) };
    scales.y.afterFit = (scale) => { scale.width = LABELS; };
    scales.y.ticks.maxTicksLimit = 7;
    if (x.log === false) scales.x.bounds = "data";
    // Curves that end earlier than the clock, beside longer ones, leave room for its cursor.
    if (this.clock && !this.level) Object.assign(scales.x, { suggestedMin: this.clock.first, suggestedMax: this.clock.last });
    return {
      type: "scatter",
      options: {
        animation: false, responsive: true, ...(this.printed ? { devicePixelRatio: PRINTED } : {}), maintainAspectRatio: false, normalized: true,
        layout: { padding: { right: 12, top: 4 } },
        interaction: { mode: "nearest", intersect: false },
        scales, plugins: { legend: { display: false }, tooltip: { callbacks: { label: ({ dataset, parsed }) => pointed(dataset.label, [y, parsed.y], [x, parsed.x]) } } },
      },
    };
  }
}

/** Curves over a pair of axes. */
class Panel extends Drawn {
  constructor(panel, holder, clock, { title, sizes, shown }) {
    const frame = element("div", { class: "panel" });
    if (panel.title) frame.append(element("h3", {}, panel.title));
    holder.append(frame);
    super(frame, clock, `${panel.title || title}: ${measure(panel.y.label).name} over ${measure(panel.x.label).name}`);
    Object.assign(this, { panel, title, size: sizes ? shown : undefined });
    this.series = panel.series.map((one) => ({ ...one, hidden: false, points: pairs(numbers(one.points)) }));
    this.keys();
  }

  keys() {
    const named = this.series.filter((one, i, all) => one.name && all.findIndex((other) => other.name === one.name) === i);
    if (!named.length) return;
    const key = (one) => {
      const told = element("span");
      const button = element("button", { class: `key${one.dashed ? " dashed" : ""}${one.joined ? "" : ` ${one.mark}`}`, "aria-pressed": true, style: `--c:${one.colour}` }, one.name, told);
      button.addEventListener("click", () => {
        const hidden = !one.hidden;
        for (const same of this.series) if (same.name === one.name) same.hidden = hidden;
        button.setAttribute("aria-pressed", !hidden);
        this.renew();
      });
      for (const same of this.series) if (same.name === one.name) Object.assign(same, { button, told });
      return button;
    };
    const keys = element("div", { class: "keys", role: "group", "aria-label": "Curves" }, ...named.map(key));
    const many = named.length > 14;
    this.plot.after(many ? element("details", {}, element("summary", {}, `${named.length} curves`), keys) : keys);
  }

  /** Shows another size of a disturbance. */
  resize(size) {
    this.size = size;
    this.renew();
  }

  /** Curves of the size that is shown, and those of all sizes. */
  current() {
    return this.series.filter((one) => (one.size ?? this.size) === this.size);
  }

  /** Values at the time of the clock beside the names. */
  tell() {
    for (const one of this.series) if (one.told) one.told.textContent = `\u2002${short(at(one.points, this.clock.time))}`;
  }

  /** Texts beside points. */
  label({ ctx, scales, chartArea }) {
    Object.assign(ctx, { fillStyle: themed("ink"), font: `12px ${Chart.defaults.font.family}`, textBaseline: "bottom" });
    for (const { points, labels, hidden } of this.series) {
      for (const [i, text] of hidden ? [] : (labels || []).entries()) {
        const x = scales.x.getPixelForValue(points[i].x) + 8;
        const width = ctx.measureText(text).width;
        ctx.fillText(text, Math.min(x, chartArea.right - width), scales.y.getPixelForValue(points[i].y) - 6);
      }
    }
  }

  /** Axes that hold the curves of all sizes. */
  hold({ options: { scales } }) {
    const points = this.series.flatMap((one) => one.points).filter((point) => Number.isFinite(point.x) && Number.isFinite(point.y));
    for (const axis of ["x", "y"]) {
      const values = points.map((point) => point[axis]);
      const [least, greatest] = [Math.min, Math.max].map((of) => values.reduce((a, b) => of(a, b), values[0]));
      Object.assign(scales[axis], { suggestedMin: least, suggestedMax: greatest });
    }
  }

  settings() {
    const { panel } = this;
    const settings = this.common(panel.x, panel.y);
    for (const axis of ["x", "y"]) {
      const values = this.series.flatMap((one) => one.points).map((point) => point[axis]).filter((value) => value > 0);
      if (!panel[axis].log || !values.length) continue;
      const [least, greatest] = [Math.min, Math.max].map((of) => values.reduce((a, b) => of(a, b)));
      Object.assign(settings.options.scales[axis], { min: oneDigit(least / 1.2), max: oneDigit(2 * greatest) });
    }
    if (this.series.some((one) => one.labels?.length)) settings.options.layout.padding.top = 18;
    const dataset = (one, i) => {
      const colour = readable(one.colour);
      one.button?.style.setProperty("--c", colour);
      return {
        label: one.name, data: panel.y.log ? one.points.filter((point) => point.y > 0) : one.points, order: -i, hidden: one.hidden, parsing: false, showLine: one.joined,
        borderColor: colour, backgroundColor: one.mark === "ring" ? themed("paper") : colour,
        borderWidth: one.joined ? one.width * 1.1 : 1.6, borderDash: one.dashed ? [6, 4] : [],
        pointStyle: one.mark === "cross" ? "crossRot" : "circle", pointRadius: one.mark === "none" ? 0 : 3.5, pointHitRadius: 6, tension: 0,
      };
    };
    settings.data = { datasets: this.current().map(dataset) };
    if (this.size !== undefined) this.hold(settings);
    settings.plugins = [{ id: "labels", afterDatasetsDraw: (chart) => this.label(chart) }];
    if (panel.equal) {
      settings.plugins.push({ id: "equal", afterLayout: (chart) => even(chart, this.series) });
      for (const axis of Object.values(settings.options.scales)) axis.afterBuildTicks = round;
    }
    return settings;
  }
}

/** Sources as rows, their values over time as colours. */
class Rows extends Drawn {
  constructor(chart, holder, clock) {
    const all = chart.panels.flatMap((panel) => panel.series);
    super(holder, clock, `${chart.title}: ${all.length} sources over time as colours`, 60 + Math.min(26, Math.max(12, 520 / all.length)) * all.length);
    this.x = chart.panels[0].x;
    this.y = chart.panels[0].y;
    this.series = all.map((one) => ({ name: one.name, points: pairs(numbers(one.points)) }));
    this.highest = Math.max(1e-12, ...this.series.flatMap((one) => one.points.map((point) => Math.abs(point.y))));
    const strip = [0, 0.25, 0.5, 0.75, 1].map((part) => `rgb(${mapped(part).map((c) => Math.round(255 * c)).join(",")})`);
    const bar = element("span", { style: `display:inline-block;width:140px;height:10px;margin:0 6px;background:linear-gradient(to right,${strip.join(",")})` });
    this.plot.after(element("p", { class: "keys" }, `${chart.panels[0].y.label}: 0`, bar, short(this.highest, 3)));
  }

  settings() {
    const count = this.series.length;
    const settings = this.common(this.x, { label: "", log: false });
    const { x, y } = settings.options.scales;
    const ends = this.series[0].points;
    Object.assign(x, { min: ends[0].x, max: ends[ends.length - 1].x });
    Object.assign(y, { min: -0.5, max: count - 0.5, reverse: true, title: { display: false }, grid: { display: false } });
    y.afterBuildTicks = (scale) => { scale.ticks = this.series.map((_, value) => ({ value })); };
    Object.assign(y.ticks, { autoSkip: true, maxTicksLimit: 60, callback: (value) => { const name = this.series[value]?.name ?? ""; return name.length > 11 ? `${name.slice(0, 10)}…` : name; }, font: { size: 10 } });
    settings.data = { datasets: [] };
    settings.plugins = [{
      id: "rows",
      beforeDatasetsDraw: ({ ctx, scales }) => this.series.forEach(({ points }, row) => {
        const [top, bottom] = [scales.y.getPixelForValue(row - 0.46), scales.y.getPixelForValue(row + 0.46)];
        for (let i = 0; i + 1 < points.length; i += 2) {
          const [left, right] = [scales.x.getPixelForValue(points[i].x), scales.x.getPixelForValue(points[i + 1].x)];
          ctx.fillStyle = `rgb(${mapped(Math.abs(points[i].y) / this.highest).map((c) => Math.round(255 * c)).join(",")})`;
          ctx.fillRect(left, top, right - left + 0.6, bottom - top);
        }
      }),
    }];
    return settings;
  }
}

/** A point in words: its curve, and its values on both axes. */
function pointed(name, ...places) {
  const words = places.map(([axis, value]) => {
    const { name: quantity, unit } = measure(axis.label);
    return `${quantity} ${valued(value, unit)}`;
  });
  return `${name ? `${name}: ` : ""}${words.join(", ")}`;
}

function pairs(values) {
  return Array.from({ length: values.length / 2 }, (_, i) => ({ x: values[2 * i], y: values[2 * i + 1] }));
}

/** The value of a curve over time; of a step the one after it. */
function at(points, time) {
  let [low, high] = [0, points.length - 1];
  if (high < 0) return NaN;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (points[middle].x <= time) low = middle;
    else high = middle;
  }
  const [a, b] = [points[low], points[high]];
  return b.x > a.x ? a.y + ((b.y - a.y) * Math.min(1, Math.max(0, (time - a.x) / (b.x - a.x)))) : b.y;
}

/** The number of one digit at or below a positive one. */
function oneDigit(value) {
  const size = 10 ** Math.floor(Math.log10(value));
  return Number((Math.floor(value / size) * size).toPrecision(1));
}

/** Ticks at round numbers, whatever the ends of an axis are. */
function round(scale) {
  const rough = (scale.max - scale.min) / 5;
  const size = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((s) => s * size).find((s) => s >= rough);
  const ticks = [];
  for (let i = Math.ceil(scale.min / step); i * step <= scale.max; i++) ticks.push({ value: Number((i * step).toPrecision(12)) });
  scale.ticks = ticks;
}

/** Layouts after which units are as equal as they become. */
const ROUNDS = 20;

/** Makes units equally long on both axes. */
function even(chart, series) {
  const all = series.flatMap((one) => one.points).filter((point) => Number.isFinite(point.x) && Number.isFinite(point.y));
  const range = (values) => [Math.min(...values), Math.max(...values)];
  const [[left, right], [low, high]] = [range(all.map((p) => p.x)), range(all.map((p) => p.y))];
  const { width, height } = chart.chartArea;
  const unit = 1.12 * Math.max((right - left) / width, (high - low) / height, 1e-6);
  const set = (scale, from, to, length) => {
    const [middle, half] = [(from + to) / 2, (unit * length) / 2];
    const options = chart.options.scales[scale];
    if (Math.abs(options.min - (middle - half)) < 1e-6 * unit * length) return false;
    Object.assign(options, { min: middle - half, max: middle + half });
    return true;
  };
  const changed = [set("x", left, right, width), set("y", low, high, height)];
  // A chart whose ticks change its area at every layout has no end.
  chart.rounds = changed.includes(true) ? ((chart.rounds ?? 0) + 1) % ROUNDS : 0;
  if (chart.rounds > 0) queueMicrotask(() => chart.ctx && chart.update("none"));
}
