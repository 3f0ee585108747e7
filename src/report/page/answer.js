// The answer in words, tables of what the run consists of, and the texts it was made from.

function answer(data, holder) {
  const verdict = element("p", { id: "verdict", class: data.isSolved ? "good" : "bad" }, data.isSolved ? "✓ " : "✗ ", ...worded(data.answer));
  holder.append(verdict);
  if (data.notes.length) {
    const notes = data.notes.map((note) => element("li", {}, ...worded(note)));
    holder.append(element("ul", { class: `notes ${data.isSolved ? "" : "bad"}` }, ...notes));
  }
  const rows = data.rows.map(([name, value]) => element("tr", {}, element("th", { scope: "row" }, name), element("td", {}, ...worded(value))));
  holder.append(element("table", {}, element("tbody", {}, ...rows)));
}

/** The command that repeats the run. */
function again(data, holder) {
  if (data.command) {
    const copy = element("button", { id: "copy" }, "Copy");
    copy.addEventListener("click", () => navigator.clipboard?.writeText(data.command).then(() => { copy.textContent = "Copied"; }));
    holder.append(element("h2", {}, "Reproduce"), element("p", {}, element("code", {}, data.command), " ", copy));
  }
}

/** Results side by side: how each ended, and what differs between them. */
function compared(data, holder) {
  const page = (text, i) => data.pages?.[i] ? element("a", { href: encodeURI(data.pages[i]), style: "color:inherit" }, text) : text;
  const name = (text, i) => element("th", { scope: "col" }, element("span", { class: "dot", style: `--c:${readable(data.colours[i])}` }), page(text, i));
  const head = element("tr", {}, element("th", { scope: "col" }, "result"), ...data.names.map(name));
  const ends = data.answers.map((text, i) => element("td", { class: data.solved[i] ? "good" : "bad" }, data.solved[i] ? "✓ " : "✗ ", ...worded(text)));
  const rows = [element("tr", {}, element("th", { scope: "row" }, "status"), ...ends)];
  for (const [title, ...values] of data.table) {
    const differs = values.some((value) => value !== values[0]);
    const cells = values.map((value, i) => element("td", {}, value + (i ? change(values[0], value) : "")));
    rows.push(element("tr", { class: differs ? "differs" : null }, element("th", { scope: "row" }, title), ...cells));
  }
  holder.append(element("div", { class: "wide", tabindex: 0, role: "region", "aria-label": "Differences" },
    element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows))));
}

/** By how much a number with its unit differs from another one of the same unit. */
function change(first, value) {
  const parts = [first, value].map((text) => /^(-?[\d.]+(?:e[-+]?\d+)?)(.*)$/.exec(text));
  if (!parts[0] || !parts[1] || parts[0][2] !== parts[1][2] || first === value) return "";
  const [a, b] = parts.map((part) => Number(part[1]));
  return a === 0 ? "" : ` (${b > a ? "+" : "−"}${short(Math.abs((100 * (b - a)) / a), 3)} %)`;
}

/** A table with a header; columns of numbers to the right. */
function table(header, rows) {
  const isNumber = header.map((_, i) => rows.every((row) => typeof row[i] === "number"));
  const cell = (kind) => (value, i) => {
    const attributes = kind === "th" ? { scope: "col", class: isNumber[i] ? "number" : null } : { class: isNumber[i] ? "number" : null };
    return element(kind, attributes, typeof value === "number" ? short(value, 6) : value ?? "");
  };
  const head = element("thead", {}, element("tr", {}, ...header.map(cell("th"))));
  const body = element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map(cell("td")))));
  return element("div", { class: "wide", tabindex: 0, role: "region", "aria-label": header[0] }, element("table", {}, head, body));
}

/** Effects, sizes and seconds of `summary.json`, then all texts. */
function tables(data, holder) {
  const documents = data.documents || [];
  const text = documents.find((document) => document.name === "Summary")?.text;
  const summary = text ? JSON.parse(text) : {};
  const fold = (title, ...children) => holder.append(element("details", {}, element("summary", {}, title), ...children));
  if (summary.effects?.length) {
    const columns = ["name", "kind", "why", "elements", "unknowns", "equations", "nonzeros", "microseconds"];
    const header = ["effect", "kind", "active because of", "elements", "unknowns", "equations", "pairs coupled", "µs"];
    const absent = (summary.absent || []).map(({ name, why }) => [name, why]);
    fold("Model terms", table(header, summary.effects.map((effect) => columns.map((column) => effect[column]))),
      ...(absent.length ? [element("h3", {}, "Inactive"), table(["effect", "why"], absent)] : []));
  }
  const plain = (value) => typeof value === "number" || typeof value === "string";
  const listed = (object, before = "") => Object.entries(object).flatMap(([name, value]) => {
    const label = `${before}${name.replaceAll("_", " ")}`;
    if (plain(value)) return [[label, value]];
    return value && typeof value === "object" && !Array.isArray(value) ? listed(value, `${label}, `) : [];
  });
  const sizes = ["intervals", "variables", "constraints", "jacobian_nonzeros", "hessian_nonzeros", "steps", "newton_iterations", "halved_steps", "factorisations", "linear_solver", "evaluations", "iterations", "blocks"];
  const found = sizes.filter((name) => summary[name] !== undefined).flatMap((name) => listed({ [name]: summary[name] }));
  if (found.length) fold("Sizes", table(["size", "number"], found));
  if (summary.seconds) fold("Seconds", table(["part", "s"], listed(summary.seconds)));
  for (const { name, text: shown } of documents) {
    fold(name, element("pre", { tabindex: 0, role: "region", "aria-label": name }, shown));
  }
}
