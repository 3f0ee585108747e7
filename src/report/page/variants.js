// Variants of a problem: any two columns against each other, all that varies side by side, all rows.

const data = JSON.parse(document.getElementById("data").textContent);
const [head, ...rows] = data.table;
/** Whether a row has an answer, and with it a page. */
const solved = data.pages.map(Boolean);
/** Columns of what varies; those before the last of them tell what was asked. */
const [first, asked] = data.varied;

/** Number and unit of a cell; none of a word. */
function quantity(cell) {
  const found = /^([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?:\s+(\S+))?$/.exec(cell);
  return found && { value: Number(found[1]), unit: found[2] || "" };
}

/** A column: numbers of one unit, or words by their order. */
function column(name, i) {
  const cells = rows.map((row) => row[i]);
  const read = cells.map(quantity);
  const units = new Set(read.filter(Boolean).map((one) => one.unit));
  if (units.size === 1 && cells.every((cell, k) => cell === "" || read[k])) {
    const [unit] = units;
    return { name: unit ? `${name} [${unit}]` : name, values: read.map((one) => (one ? one.value : NaN)) };
  }
  const words = [...new Set(cells)];
  return { name, words, values: cells.map((cell) => words.indexOf(cell)) };
}

const columns = head.map(column);
const told = (one, value) => (one.words ? one.words[value] : short(value, 6));

/** Range of an axis with room at its ends, and where its marks stand. */
function axis(one, count) {
  const known = one.values.filter(Number.isFinite);
  let [low, high] = known.length ? [Math.min(...known), Math.max(...known)] : [0, 1];
  if (low === high) {
    const half = Math.abs(low) / 20 || 1;
    [low, high] = [low - half, high + half];
  }
  const rough = (high - low) / count;
  const size = 10 ** Math.floor(Math.log10(rough));
  const length = [1, 2, 5, 10].map((s) => s * size).find((s) => s >= rough);
  const marks = [];
  for (let i = Math.ceil(low / length - 1e-9); i * length <= high + 1e-9 * length; i++) marks.push(Number((i * length).toPrecision(12)));
  const margin = 0.05 * (high - low);
  return { low: low - margin, high: high + margin, marks: one.words ? one.words.map((_, i) => i).filter((i) => i >= low && i <= high) : marks };
}

/** A choice among the columns. */
function choice(label, id, entries, chosen) {
  const select = element("select", { id, "aria-label": label, onchange: draw }, ...entries.map(([value, name]) => element("option", { value }, name)));
  document.getElementById("options").append(element("label", {}, label.toLowerCase(), select));
  select.value = chosen;
  return select;
}

const entries = columns.map((one, i) => [i, one.name]).slice(1);
const objective = head.indexOf("objective");
const across = choice("Horizontal", "x", entries, Math.min(first, head.length - 1));
const upward = choice("Vertical", "y", entries, objective > 0 ? objective : Math.min(asked, head.length - 1));
const tint = choice("Colour", "colour", [["", "none"], ...entries], asked - first > 1 ? first + 1 : "");

/** The colour of each row by the column that is chosen, and of any value of it. */
function paint() {
  if (tint.value === "") return { of: () => "var(--accent)", at: null };
  const third = columns[tint.value];
  const known = third.values.filter(Number.isFinite);
  const [low, high] = [Math.min(...known), Math.max(...known)];
  // The lightest colours of the map do not show on white.
  const at = (value) => `rgb(${mapped(0.12 + 0.88 * (high > low ? (value - low) / (high - low) : 0)).map((c) => Math.round(255 * c)).join(" ")})`;
  return { of: (k) => (Number.isFinite(third.values[k]) ? at(third.values[k]) : "var(--muted)"), at, third, values: [...new Set(known)].sort((a, b) => a - b) };
}

/** What a row was, for whoever points at it. */
const words = (k) => drawn("title", {}, head.slice(0, asked + 1).map((name, i) => `${name}: ${rows[k][i]}`).join("\n"));

function draw() {
  const colours = paint();
  key(colours);
  scatter(colours);
  parallel(colours);
}

function key({ at, third, values }) {
  const mark = (colour, sign, text) => element("span", {}, element("span", { style: `color:${colour}`, "aria-hidden": "true" }, sign), ` ${text}`);
  const marks = [];
  if (!third) marks.push(mark("var(--accent)", "●", "with an answer"));
  else {
    const ends = [values[0], values[values.length - 1]];
    const few = values.length <= 8 || third.words ? values : [0, 0.25, 0.5, 0.75, 1].map((part) => ends[0] + part * (ends[1] - ends[0]));
    marks.push(`${third.name}:`, ...few.map((value) => mark(at(value), "●", third.words ? third.words[value] : short(value))));
  }
  if (solved.includes(false)) marks.push(mark("var(--bad)", "○", "without an answer"));
  document.getElementById("key").replaceChildren(...marks);
}

function scatter(colours) {
  const plot = document.getElementById("plot");
  const [left, right, top, bottom] = [86, 670, 10, 345];
  const [x, y] = [columns[across.value], columns[upward.value]];
  const [ax, ay] = [axis(x, 6), axis(y, 6)];
  const place = (value) => left + ((value - ax.low) / (ax.high - ax.low)) * (right - left);
  const height = (value) => bottom - ((value - ay.low) / (ay.high - ay.low)) * (bottom - top);
  plot.replaceChildren();
  plot.setAttribute("aria-label", `${y.name} over ${x.name}`);
  for (const mark of ax.marks) {
    plot.append(drawn("line", { class: "grid", x1: place(mark), x2: place(mark), y1: top, y2: bottom }));
    plot.append(drawn("text", { class: "tick", x: place(mark), y: bottom + 18, "text-anchor": "middle" }, told(x, mark)));
  }
  for (const mark of ay.marks) {
    plot.append(drawn("line", { class: "grid", x1: left, x2: right, y1: height(mark), y2: height(mark) }));
    plot.append(drawn("text", { class: "tick", x: left - 8, y: height(mark) + 4, "text-anchor": "end" }, told(y, mark)));
  }
  plot.append(drawn("rect", { class: "axis", x: left, y: top, width: right - left, height: bottom - top }));
  plot.append(drawn("text", { x: (left + right) / 2, y: 388, "text-anchor": "middle" }, x.name));
  plot.append(drawn("text", { x: 16, y: (top + bottom) / 2, "text-anchor": "middle", transform: `rotate(-90 16 ${(top + bottom) / 2})` }, y.name));
  rows.forEach((_, k) => {
    if (!Number.isFinite(x.values[k]) || !Number.isFinite(y.values[k])) return;
    const point = drawn("circle", { class: solved[k] ? "" : "not", cx: place(x.values[k]), cy: height(y.values[k]), r: 5 });
    if (solved[k]) point.style.fill = colours.of(k);
    point.append(words(k));
    plot.append(point);
  });
}

/** An axis for each column that varies, then for the chosen ones that do not; a line for each row. */
function parallel(colours) {
  const plot = document.getElementById("parallel");
  const [left, right, top, bottom] = [60, 650, 44, 388];
  const varied = columns.map((_, i) => i).slice(first, asked);
  const chosen = [upward.value, across.value, tint.value].filter((value) => value !== "").map(Number);
  const shown = [...new Set([...varied, ...chosen])];
  plot.replaceChildren();
  plot.setAttribute("aria-label", `Parallel coordinates of ${shown.map((i) => columns[i].name).join(", ")}`);
  const axes = shown.map((i, a) => ({ one: columns[i], ...axis(columns[i], 5), x: left + (shown.length > 1 ? (a * (right - left)) / (shown.length - 1) : 0) }));
  const height = ({ low, high }, value) => bottom - ((value - low) / (high - low)) * (bottom - top);
  rows.forEach((_, k) => {
    const points = axes.filter(({ one }) => Number.isFinite(one.values[k])).map((each) => `${each.x} ${height(each, each.one.values[k])}`);
    if (points.length < 2) return;
    const line = drawn("path", { class: solved[k] ? "" : "not", d: `M${points.join("L")}` });
    if (solved[k]) line.style.stroke = colours.of(k);
    line.append(words(k));
    plot.append(line);
  });
  axes.forEach((each, a) => {
    plot.append(drawn("line", { class: "axis", x1: each.x, x2: each.x, y1: top, y2: bottom }));
    for (const mark of each.marks) plot.append(drawn("text", { class: "tick", x: each.x - 6, y: height(each, mark) + 4, "text-anchor": "end" }, told(each.one, mark)));
    // The last part of a place in the problem tells it apart, neighbours stand in two rows.
    const name = each.one.name.split(".").slice(-1)[0];
    plot.append(drawn("text", { x: each.x, y: a % 2 ? 12 : 28, "text-anchor": a === 0 ? "start" : a === axes.length - 1 ? "end" : "middle" }, name));
  });
}

let sorted = { by: -1, sign: 1 };

function list() {
  const order = [...rows.keys()];
  if (sorted.by >= 0) {
    const place = (k) => (Number.isNaN(columns[sorted.by].values[k]) ? Infinity : columns[sorted.by].values[k]);
    order.sort((a, b) => (place(a) - place(b) || 0) * sorted.sign);
  }
  const title = (name, i) => {
    const button = element("button", { onclick: () => {
      sorted = { by: i, sign: sorted.by === i ? -sorted.sign : 1 };
      list();
      document.querySelectorAll("#rows th button")[i].focus();
    } }, name);
    return element("th", { scope: "col", "aria-sort": sorted.by !== i ? null : sorted.sign > 0 ? "ascending" : "descending" }, button);
  };
  const cell = (text, i, k) => {
    const number = i > 1 && quantity(text);
    if (i === 0 && solved[k]) return element("td", {}, element("a", { href: data.pages[k] }, text));
    return element("td", { class: number ? "number" : null }, number && !number.unit ? short(number.value, 7) : text);
  };
  const body = order.map((k) => element("tr", {}, ...rows[k].map((text, i) => cell(text, i, k))));
  document.getElementById("rows").replaceChildren(element("thead", {}, element("tr", {}, ...head.map(title))), element("tbody", {}, ...body));
}

document.getElementById("system").textContent = data.title;
document.getElementById("kind").textContent = data.kind;
const all = solved.every(Boolean);
document.getElementById("answer").append(element("p", { id: "verdict", class: all ? "good" : "bad" }, `${all ? "✓" : "✗"} ${data.words}`));
draw();
list();
