// Colours of the page, light or dark, and the map from quantities to colours.

/** Stops of the map `magma` of matplotlib, from its light end. */
const MAGMA = [[252, 253, 191], [254, 207, 146], [254, 159, 109], [247, 112, 92], [222, 73, 104], [183, 55, 121], [140, 41, 129]];

/** Whether the page is being printed, on white paper. */
const isPrinted = () => document.documentElement.classList.contains("printed");
window.addEventListener("beforeprint", () => document.documentElement.classList.add("printed"));
window.addEventListener("afterprint", () => document.documentElement.classList.remove("printed"));

const dark = window.matchMedia("(prefers-color-scheme: dark)");

/** A colour of the sheet. */
const themed = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Red, green and blue of a part of the full scale, from 0 to 1. */
function mapped(part) {
  const place = Math.min(1, Math.max(0, part || 0)) * (MAGMA.length - 1);
  const below = Math.min(Math.floor(place), MAGMA.length - 2);
  const mix = (i) => (MAGMA[below][i] + (MAGMA[below + 1][i] - MAGMA[below][i]) * (place - below)) / 255;
  return [mix(0), mix(1), mix(2)];
}

/** Steps of the map for what changes colour with every picture, red, green and blue of each. */
const STEPS = 255;
const TABLE = new Float32Array(Array.from({ length: STEPS + 1 }, (_, i) => mapped(i / STEPS)).flat());

/** Where the colour of a part of the full scale begins in the table. */
const step = (part) => 3 * Math.round(STEPS * Math.min(1, Math.max(0, part || 0)));

/** The colour of a curve on the paper of the theme: ink stays ink, dark ones become lighter on dark paper. */
function readable(colour) {
  if (colour === "#22262b") return themed("ink");
  if (colour === "#8a9098") return themed("muted");
  if (!dark.matches || isPrinted()) return colour;
  const channels = [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16));
  const light = (0.3 * channels[0] + 0.59 * channels[1] + 0.11 * channels[2]) / 255;
  const lift = Math.max(0, 0.55 - light);
  return `rgb(${channels.map((c) => Math.round(c + (255 - c) * lift)).join(",")})`;
}
