// What the page was given: numbers in base64, libraries that are packed, elements by their names.

/** Numbers in single precision. */
const numbers = (text) => new Float32Array(bytes(text).buffer);

/** Indices. */
const indices = (text) => new Uint32Array(bytes(text).buffer);

function bytes(text) {
  const read = atob(text);
  const found = new Uint8Array(read.length);
  for (let i = 0; i < read.length; i++) found[i] = read.charCodeAt(i);
  return found;
}

/** Runs a library that is packed in the element of its name. */
async function unpack(name) {
  const packed = new Blob([bytes(document.getElementById(`library-${name}`).textContent)]);
  const code = await new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).text();
  const script = document.createElement("script");
  script.textContent = code;
  document.head.append(script);
}

/** A new element with its attributes and what it holds. */
function element(kind, attributes = {}, ...children) {
  const made = document.createElement(kind);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

/** The namespace of drawings, whose name is an address that nobody is to ask. */
const DRAWINGS = (() => {
  const holder = document.createElement("template");
  holder.innerHTML = "<svg></svg>";
  return holder.content.firstChild.namespaceURI;
})();

/** A new element of a drawing. */
function drawn(name, attributes, text) {
  const made = document.createElementNS(DRAWINGS, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

/** A text whose names in backticks are set as names. */
function worded(text) {
  const named = (part, i) => (i % 2 ? element("code", {}, part) : part);
  const parts = text.split(/`([^`]+)`/);
  return parts.map(named);
}

/** What an axis or a scale measures, and its unit. */
function measure(label) {
  const [, name, unit] = /^(.*?)(?: \[(.*)\])?$/.exec(label);
  return { name, unit: unit || "" };
}

/** A value with its unit. */
const valued = (value, unit) => (unit === "°" ? `${short(value)}°` : unit ? `${short(value)} ${unit}` : short(value));

/** A number with so many significant digits, short. */
function short(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(Math.max(0, digits - 2)).replace(/\.?0+e/, "e");
  return String(Number(value.toPrecision(digits)));
}
