// Pages in a real Chromium: `node check.js BINARY FOLDER [NAME…]` runs problems with the program, all or those named, opens their pages on a
// laptop and a phone, in light and dark, and writes screenshots to the folder.

import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [binary, folder, ...named] = process.argv.slice(2);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const solve = (name) => [["solve", `problems/${name}.json`]];
/** A study of steps, and a trunk of so many joints that its voltages are rows of colours. */
const STUDY = {
  title: "Steps of a pair", problem: resolve("problems/pair_constant.json"), set: { "simulate.duration": "0.1 s" },
  methods: [{ name: "midpoint" }, { name: "redundant", set: { "simulate.coordinates": "redundant" } }], refine: { name: "step", set: { "simulate.step": ["10 ms", "5 ms", "2.5 ms", "1.25 ms"] } },
};
const SWING = { scene: "scene.json", simulate: { duration: "0.2 s", step: "4 ms", voltages: { muscle1: "2 kV", muscle6: "1 kV" } } };
/** A pair whose marker is to end near a place. */
const AIM = ["--set", "control.goal=free", "--set", 'control.objective={"effort": 1, "final": [{"marker": {"marker": "tip", "at": ["-12 mm", "60 mm", null]}}]}'];
/** Variants of a pair of two materials' constants. */
const SWEEP = {
  title: "Stiffness and permittivity", problem: resolve("problems/pair.json"),
  vary: { "scene.materials.silicone.shear_modulus": ["50 kPa", "100 kPa", "200 kPa"], "scene.materials.silicone.relative_permittivity": [2.5, 4] },
};
/** Results, and what their pages show: so many parts that move or not, faces of finite elements, charts with these titles. */
const RUNS = [
  { name: "elephant_trunk", commands: solve("elephant_trunk"), moves: true, parts: 18, charts: ["Voltages", "Joints", "Energies", "Convergence"], megabytes: 1.5, names: ["tip, optimal voltages", "constant voltages", "ground"] },
  { name: "fe_trunk", commands: [["simulate", "problems/fe_trunk.json"]], moves: true, parts: 18, faces: 864, charts: ["Voltages", "Stretches", "Charges"], megabytes: 3 },
  { name: "bending_actuator", commands: solve("bending_actuator"), moves: false, parts: 1, faces: 916, charts: [], megabytes: 1, names: ["reference configuration"] },
  { name: "clamped_stack", commands: solve("clamped_stack"), moves: false, parts: 1, faces: 288, charts: [], megabytes: 1, names: ["reference configuration", "ground"] },
  { name: "pull_in", commands: solve("pull_in"), moves: true, walks: true, parts: 1, faces: 24, charts: ["Path"], megabytes: 1 },
  { name: "long_trunk", commands: [["new", "trunk", "--segments", "14", "FOLDER/scene"], ["simulate", "FOLDER/scene/swing.json"]], moves: true, parts: 42, charts: ["Voltages"], megabytes: 3 },
  { name: "aimed", commands: [["solve", "problems/pair.json", ...AIM]], moves: true, parts: 3, charts: ["Voltages"], megabytes: 1, target: [-12, 60, 0] },
  { name: "disturbed", commands: [["simulate", "problems/pair_disturbed.json"]], moves: true, parts: 3, charts: ["Disturbance", "Voltages"], megabytes: 1.5, sizes: [0, 0.25, 0.5, 1] },
  { name: "identified", commands: solve("recorded_pair"), moves: true, parts: 3, charts: ["angle", "angle, residuals", "Voltages", "Joints"], megabytes: 2, motions: ["step", "sine"], row: /^\d+\.\d+ kPa ± 0\.\d+ / },
  { name: "study", commands: [["study", "FOLDER/study.json"]], charts: [], megabytes: 1 },
  { name: "sweep", commands: [["sweep", "FOLDER/sweep.json"]], variants: 6, charts: [], megabytes: 0.1 },
  { name: "compared", commands: [["report", "FOLDER/elephant_trunk", "FOLDER/long_trunk"]], moves: true, parts: 18, charts: ["Joints", "Energies"], megabytes: 3, motions: ["elephant_trunk", "long_trunk"] },
];
const SCREENS = [
  { name: "laptop", width: 1400, height: 900, scheme: "light" },
  { name: "phone", width: 400, height: 800, scheme: "dark" },
  { name: "laptop-dark", width: 1400, height: 900, scheme: "dark", still: true },
  { name: "phone-light", width: 400, height: 800, scheme: "light", still: true },
];

const PROGRAM = process.env.CHROMIUM || "/usr/bin/chromium";
// Without a graphics card charts are drawn faster by the processor itself than by the card that it plays.
const ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-accelerated-2d-canvas"];

let [passed, failed] = [0, 0];
function expect(is, what) {
  if (is) passed += 1;
  else {
    failed += 1;
    console.error(`browser: ${what}`);
  }
}

/** Least and greatest place of all that is drawn of the robot, in px of the canvas, at some instants; taken from the triangles, not from the camera's own box. */
function drawn() {
  const { scene, clock } = window.proboscis;
  const three = scene.camera.three;
  const [width, height] = [scene.canvas.clientWidth, scene.canvas.clientHeight];
  const found = [];
  const before = clock.time;
  for (let i = 0; i <= 40; i++) {
    clock.set(clock.first + ((clock.last - clock.first) * i) / 40);
    scene.root.updateMatrixWorld(true);
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (const part of scene.parts) {
      part.object.traverse((object) => {
        const position = object.isMesh && object.geometry.attributes.position;
        for (let v = 0; position && v < position.count; v++) {
          const at = new THREE.Vector3().fromBufferAttribute(position, v).applyMatrix4(object.matrixWorld).project(three);
          const [x, y] = [((at.x + 1) / 2) * width, ((1 - at.y) / 2) * height];
          box[0] = Math.min(box[0], x);
          box[1] = Math.min(box[1], y);
          box[2] = Math.max(box[2], x);
          box[3] = Math.max(box[3], y);
        }
      });
    }
    found.push(box);
  }
  clock.set(before);
  return { found, width, height };
}

async function look(browser, run, screen, file) {
  const told = `${run.name} on ${screen.name}`;
  const context = await browser.newContext({ viewport: screen, colorScheme: screen.scheme });
  const page = await context.newPage();
  page.setDefaultTimeout(180000);
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && expect(/GPU stall|swiftshader/i.test(message.text()), `${told}: ${message.text()}`));
  page.on("pageerror", (error) => expect(false, `${told}: ${error.message}`));
  page.on("request", (request) => expect(/^(file|data|blob):/.test(request.url()), `${told}: asks for ${request.url()}`));
  await page.goto(pathToFileURL(file).href);
  await page.waitForFunction(() => window.proboscis?.charts || document.querySelector("#plot circle"), null, { timeout: 180000 });
  await page.waitForTimeout(150);
  await page.screenshot({ path: join(folder, `${run.name}-${screen.name}.png`) });
  if (!screen.still) {
    if (run.parts) {
      await scene(page, run, told);
      await gauge(page, run, told);
      await picture(page, run, told);
      await controls(page, run, told);
    }
    await keyboard(page, told);
    if (run.variants) await sweep(page, run, told);
    else {
      await charts(page, run, told, screen);
      await pointed(page, told);
      if (run.sizes) await slide(page, run, told);
      if (run.motions) await motions(page, run, told);
    }
  }
  if (!run.variants) await paper(page, run, told);
  const words = await page.evaluate(() => document.querySelector("main").innerText);
  expect(words.length > 50 && !words.includes("`"), `${told}: backticks in ${words.match(/.{0,40}`.{0,40}/)}`);
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.evaluate(axe);
  const found = await page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
  for (const violation of found.violations) {
    const place = violation.nodes[0].html.slice(0, 120);
    expect(!["serious", "critical"].includes(violation.impact), `${told}: ${violation.id}, ${violation.help}: ${place}`);
  }
  expect(found.passes.length > 10, `${told}: axe checked nothing`);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
  expect(wide <= 0, `${told}: ${wide} px wider than the screen`);
  if (!screen.still) {
    // For a person to look at, and last: long pages take a slow machine more time than the test has, and the page does nothing else meanwhile.
    const all = { path: join(folder, `${run.name}-${screen.name}-all.png`), fullPage: true, timeout: 30000 };
    await page.screenshot(all).catch(() => console.error(`browser: ${told}: no picture of the whole page`));
  }
  await Promise.race([context.close(), new Promise((resolve) => setTimeout(resolve, 10000))]);
}

/** The robot is framed at every instant, and large. */
async function scene(page, run, told) {
  const parts = await page.evaluate(() => window.proboscis.scene.parts.length);
  expect(parts === run.parts, `${told}: ${parts} parts`);
  const { found, width, height } = await page.evaluate(drawn);
  const inside = (box) => box[0] >= 0 && box[1] >= 0 && box[2] <= width && box[3] <= height;
  expect(found.every(inside), `${told}: the robot leaves the picture, ${found.find((box) => !inside(box))} of ${width} × ${height}`);
  const fills = Math.max(...found.map((box) => Math.max((box[2] - box[0]) / width, (box[3] - box[1]) / height)));
  expect(fills > 0.5, `${told}: the robot fills ${fills} of the picture`);
  const colours = await page.evaluate(() => {
    const { picture: { renderer }, root, camera } = window.proboscis.scene;
    renderer.render(root, camera.three);
    const copy = Object.assign(document.createElement("canvas"), { width: 80, height: 80 });
    const pen = copy.getContext("2d");
    pen.drawImage(renderer.domElement, 0, 0, 80, 80);
    const data = pen.getImageData(0, 0, 80, 80).data;
    return new Set(Array.from({ length: 6400 }, (_, i) => data.slice(4 * i, 4 * i + 4).join())).size;
  });
  expect(colours > 20, `${told}: the picture has ${colours} colours`);
}

/** The bar of the scale is as long as it says, names tell what lines are, and the ground is there. */
async function gauge(page, run, told) {
  const { bar, label, apart, names } = await page.evaluate(() => {
    const { scene } = window.proboscis;
    scene.camera.enlarge(1.7);
    const path = document.querySelector("#gauge path").getAttribute("d");
    const [, left, right] = /^M([\d.]+) .*H([\d.]+)V/.exec(path).map(Number);
    const label = document.querySelector("#gauge text:last-of-type").textContent;
    const length = Number.parseFloat(label) * { "µm": 1e-3, mm: 1, m: 1e3 }[label.split(" ")[1]];
    const along = new THREE.Vector3(...scene.camera.axes().right).multiplyScalar(length);
    const [a, b] = [new THREE.Vector3(), along].map((place) => ((place.project(scene.camera.three).x + 1) / 2) * scene.canvas.clientWidth);
    scene.camera.look("auto");
    return { bar: right - left, label, apart: b - a, names: [...document.querySelectorAll("#legend li")].map((one) => one.textContent) };
  });
  expect(bar > 10 && Math.abs(bar - apart) < 0.01 * bar, `${told}: a bar of ${label} has ${bar} px in place of ${apart}`);
  for (const name of run.names || []) expect(names.includes(name), `${told}: ${name} is not named among ${names}`);
}

/** What a curve says of a point has the units of its axes. */
async function pointed(page, told) {
  const wrong = await page.evaluate(() => window.proboscis.charts.made.filter((one) => one.panel).flatMap(({ panel, chart }) => {
    const { label } = chart.options.plugins.tooltip.callbacks;
    const words = label({ dataset: { label: "curve" }, parsed: { x: 2, y: 3 } });
    const units = [panel.x.label, panel.y.label].map((text) => /\[(.*)\]/.exec(text)?.[1]).filter(Boolean);
    return units.every((unit) => words.includes(unit)) && words.startsWith("curve: ") ? [] : [`${words} for ${panel.y.label} over ${panel.x.label}`];
  }));
  expect(wrong.length === 0, `${told}: tool tips say ${wrong}`);
}

/** On paper there are all charts and the scene, light and with ink on them, and then the screen is as before. */
async function paper(page, run, told) {
  const dressed = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const before = await dressed();
  const found = await page.evaluate(() => {
    const inked = (canvas) => {
      const copy = Object.assign(document.createElement("canvas"), { width: 60, height: 60 });
      const pen = copy.getContext("2d");
      pen.drawImage(canvas, 0, 0, 60, 60);
      const data = pen.getImageData(0, 0, 60, 60).data;
      return new Set(Array.from({ length: 3600 }, (_, i) => data.slice(4 * i, 4 * i + 4).join())).size;
    };
    window.dispatchEvent(new Event("beforeprint"));
    const charts = window.proboscis.charts.made.map((one) => inked(one.canvas));
    const still = document.getElementById("still");
    const told = { charts, scene: still && inked(still), paper: getComputedStyle(document.body).backgroundColor };
    window.dispatchEvent(new Event("afterprint"));
    return told;
  });
  expect(found.charts.every((colours) => colours > 5), `${told}: charts on paper have ${found.charts} colours`);
  if (run.parts) expect(found.scene > 20, `${told}: the scene on paper has ${found.scene} colours`);
  expect(found.paper === "rgb(255, 255, 255)" && (await dressed()) === before, `${told}: paper is ${found.paper}, the screen ${await dressed()} after ${before}`);
  const printed = await page.pdf({ format: "A4" });
  writeFileSync(join(folder, `${told.replaceAll(" ", "-")}.pdf`), printed);
  expect(!run.parts || printed.toString("latin1").includes("/Subtype /Image"), `${told}: no picture on paper`);
}

/** What the command line of the browser prints is drawn. */
function fromCommandLine(file, run) {
  const pdf = join(folder, `${run.name}.pdf`);
  execFileSync(PROGRAM, ["--headless", ...ARGUMENTS, `--print-to-pdf=${pdf}`, pathToFileURL(file).href], { stdio: "ignore" });
  const printed = readFileSync(pdf);
  // Without scene and charts it has 75 kB.
  expect(printed.length > 2e5 && printed.toString("latin1").includes("/Subtype /Image"), `${run.name}: ${printed.length} bytes are printed from the command line`);
}

/** Normals of faces point where their triangles do, at every instant, and the picture is fine again at rest. */
async function picture(page, run, told) {
  const { faces, wrong } = await page.evaluate(() => {
    const { scene, clock } = window.proboscis;
    const counted = { faces: 0, wrong: 0 };
    for (let i = 0; i <= 10; i++) {
      clock.set(clock.first + ((clock.last - clock.first) * i) / 10);
      for (const { surface } of scene.parts.filter((part) => part.surface)) {
        const corner = (name, v) => new THREE.Vector3().fromBufferAttribute(surface.attributes[name], v);
        const index = surface.index.array;
        for (let t = 0; t < index.length; t += 3) {
          const [a, b, c] = [0, 1, 2].map((v) => corner("position", index[t + v]));
          const normal = b.sub(a).cross(c.sub(a)).normalize();
          counted.faces += 1;
          counted.wrong += [0, 1, 2].some((v) => !(corner("normal", index[t + v]).normalize().dot(normal) > 0.9));
        }
      }
    }
    return counted;
  });
  expect(wrong === 0, `${told}: ${wrong} of ${faces} triangles have normals that are not theirs`);
  expect(run.faces ? faces === 22 * run.faces : faces === 0, `${told}: ${faces} triangles of faces in 11 pictures`);
  const resolution = () => page.evaluate(() => window.proboscis.scene.picture.renderer.getPixelRatio());
  await page.waitForTimeout(500);
  const finest = await page.evaluate(() => window.proboscis.scene.picture.finest);
  expect(finest >= 2 && (await resolution()) === finest, `${told}: at rest ${await resolution()} pixels along a px, not ${finest}`);
  if (!run.moves) return;
  // As where drawing is slow.
  await page.evaluate(() => {
    const { picture } = window.proboscis.scene;
    picture.measure = () => { picture.coarse = 1; picture.draw(picture.finest); };
    window.proboscis.clock.play(true);
  });
  await page.waitForFunction(() => window.proboscis.scene.picture.renderer.getPixelRatio() === 1, null, { timeout: 20000 }).catch(() => expect(false, `${told}: it plays finely where drawing is slow`));
  await page.evaluate(() => window.proboscis.clock.play(false));
  await page.waitForFunction((is) => window.proboscis.scene.picture.renderer.getPixelRatio() === is, finest, { timeout: 20000 }).catch(() => expect(false, `${told}: it stays coarse at rest`));
}

/** The slider moves the scene, colours change, keys turn it. */
async function controls(page, run, told) {
  const place = () => page.evaluate(() => {
    const { parts } = window.proboscis.scene;
    const last = parts[Math.min(5, parts.length - 1)];
    return last.now ? Array.from(last.now).slice(0, 12).join() : "";
  });
  if (run.moves) {
    const before = await place();
    await page.locator("#time").fill("300");
    expect((await place()) !== before, `${told}: the slider does not move the scene`);
    const time = await page.evaluate(() => window.proboscis.clock.time / window.proboscis.clock.last);
    if (run.walks) await path(page, told);
    expect(Math.abs(time - 0.3) < 1e-3, `${told}: the slider sets ${time}`);
    await page.locator("#play").click();
    await page.waitForFunction((before) => window.proboscis.clock.time / window.proboscis.clock.last > before, time, { timeout: 20000 }).catch(() => expect(false, `${told}: it does not play`));
    await page.locator("#play").click();
  }
  if (run.target) {
    const arms = await page.evaluate(() => window.proboscis.scene.groups.goal.children.map((one) => one.position.toArray()));
    const shown = await page.locator("#show-goal").getAttribute("aria-pressed");
    expect(arms.length === 3 && shown === "true" && arms.every((arm) => arm.every((x, i) => Math.abs(x - run.target[i]) < 1e-4)), `${told}: crosses at ${arms}, shown ${shown}`);
  }
  const painted = () => page.evaluate(() => window.proboscis.scene.parts.map((part) => (part.surface ? part.surface.attributes.color.array.join() : part.material.color.getHexString())).join());
  const quantities = await page.locator("#colour option").evaluateAll((all) => all.map((one) => one.value));
  await page.evaluate(() => window.proboscis.clock.set(window.proboscis.clock.last));
  const seen = new Set();
  for (const quantity of quantities) {
    await page.locator("#colour").selectOption(quantity);
    seen.add(await painted());
  }
  expect(quantities.length >= 3 && seen.size > 1, `${told}: ${quantities} paint ${seen.size} ways`);
  const turned = await page.evaluate(() => {
    const { scene: { canvas, camera } } = window.proboscis;
    const before = camera.azimuth;
    canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
    const by = camera.azimuth - before;
    camera.look("auto");
    return by;
  });
  expect(turned !== 0, `${told}: keys do not turn the scene`);
}

/** A path of equilibria: the slider shows their fractions, up to the limit and back; the block is as stretched as the curve of the path says. */
async function path(page, told) {
  const found = await page.evaluate(() => {
    const { clock, scene, charts: { made: [chart] } } = window.proboscis;
    const curve = chart.series.filter((one) => one.joined).flatMap((one) => one.points);
    const marker = scene.markers[0];
    const start = marker.path.slice(0, 3);
    const before = clock.time;
    let worst = 0;
    const fractions = [];
    for (let k = 0; k <= clock.last; k++) {
      clock.set(k);
      fractions.push(clock.fraction());
      const far = Math.hypot(...[0, 1, 2].map((a) => scene.groups.paths.children.find((one) => one.geometry?.type === "SphereBufferGeometry").position.getComponent(a) - start[a]));
      const nearest = Math.min(...curve.map((point) => Math.hypot(point.x - far, point.y - clock.fraction())));
      worst = Math.max(worst, nearest / Math.max(...curve.map((point) => point.x)));
    }
    clock.set(before);
    return { worst, fractions, told: document.querySelector("#player output").textContent };
  });
  const most = Math.max(...found.fractions);
  expect(found.worst < 1e-4 && most > 0.9 && found.fractions[found.fractions.length - 1] < most, `${told}: the scene is ${found.worst} beside the path, fractions ${found.fractions}`);
  expect(/^\d+\.\d\d % of the voltages$/.test(found.told), `${told}: the path is told as ${found.told}`);
}

/** Each variant is a point and a line; columns that are chosen move and colour them, heads of columns sort the rows. */
async function sweep(page, run, told) {
  const points = () => page.locator("#plot circle").evaluateAll((all) => all.map((one) => [one.getAttribute("cx"), one.getAttribute("cy"), one.style.fill].join(" ")));
  const before = await points();
  const lines = await page.locator("#parallel path").count();
  expect(before.length === run.variants && new Set(before).size === run.variants && lines === run.variants, `${told}: points ${before}, ${lines} lines`);
  for (const [axis, value] of [["#x", "objective"], ["#y", "iterations"], ["#colour", "objective"]]) {
    const earlier = await points();
    await page.locator(axis).selectOption({ label: value });
    expect((await points()).some((point, i) => point !== earlier[i]), `${told}: ${value} for ${axis} changes nothing`);
  }
  const column = () => page.locator("#rows tbody tr td:nth-child(7)").evaluateAll((all) => all.map((one) => Number(one.textContent)));
  for (const sign of [1, -1]) {
    await page.locator("#rows th button").nth(6).click();
    const values = await column();
    expect(values.length === run.variants && values.every((value, i) => i === 0 || sign * (value - values[i - 1]) >= 0), `${told}: sorted by the objective are ${values}`);
    expect(sign * (values[values.length - 1] - values[0]) > 0, `${told}: all objectives are ${values}`);
  }
  const links = await page.locator("#rows a").evaluateAll((all) => all.map((one) => one.getAttribute("href")));
  expect(links.length === run.variants && links.every((link) => existsSync(join(folder, run.name, link))), `${told}: links to ${links}`);
}

/** The keyboard reaches all controls. */
async function keyboard(page, told) {
  const controls = await page.evaluate(() => {
    document.querySelectorAll("details").forEach((one) => { one.open = true; });
    const all = [...document.querySelectorAll("button, select, input, summary, [tabindex='0']")];
    all.forEach((one, i) => { one.dataset.control = i; });
    document.activeElement?.blur();
    return all.length;
  });
  const reached = new Set();
  for (let i = 0; i < 2 * controls && reached.size < controls; i++) {
    await page.keyboard.press("Tab");
    const control = await page.evaluate(() => document.activeElement?.dataset?.control);
    if (control !== undefined) reached.add(control);
  }
  expect(reached.size === controls, `${told}: the keyboard reaches ${reached.size} of ${controls} controls`);
  await page.evaluate(() => document.querySelectorAll("details").forEach((one) => { one.open = false; }));
}

/** Charts are there, are drawn, stand below each other, and have the cursor at the time of the scene. */
async function charts(page, run, told, screen) {
  const titles = await page.locator("#charts h2").allTextContents();
  for (const title of run.charts) expect(titles.includes(title), `${told}: no chart of ${title} among ${titles}`);
  for (const plot of await page.locator(".plot").all()) {
    await plot.scrollIntoViewIfNeeded();
    const drawn = (one) => window.proboscis.charts.made.some(({ plot, chart, clock, cursor }) => plot === one && chart && (!clock || cursor.style.display === "block"));
    // What is not drawn fails below.
    await page.waitForFunction(drawn, await plot.elementHandle(), { timeout: 20000 }).catch(() => {});
  }
  const left = await page.evaluate(() => {
    const areas = window.proboscis.charts.made.filter((one) => one.clock && one.chart).map((one) => [one.plot.getBoundingClientRect().left, one.chart.chartArea.left, one.cursor.style.display]);
    return { edges: [...new Set(areas.map(([a, b]) => `${Math.round(a)} ${Math.round(b)}`))], cursors: areas.every((one) => one[2] === "block"), count: areas.length };
  });
  if (run.walks) expect(left.count === 1 && left.cursors, `${told}: the path has no mark`);
  else if (run.moves) {
    expect(left.count > 3 && left.cursors, `${told}: ${left.count} charts follow the clock`);
    if (screen.width < 600) expect(left.edges.length === 1, `${told}: time axes begin at ${left.edges}`);
  }
  const empty = await page.evaluate(() => window.proboscis.charts.made.filter((one) => !one.chart).length);
  expect(empty === 0, `${told}: ${empty} charts are not drawn`);
}

/** Another motion takes the place of the first one: its scene, its clock and its charts; constants have units that suit them. */
async function motions(page, run, told) {
  const shown = () => page.evaluate(() => {
    const { scene, charts } = window.proboscis;
    return { name: scene.data.name, canvases: document.querySelectorAll("#view canvas[role]").length, charts: charts.made.length, times: scene.times.length };
  });
  const names = await page.locator("#motion option").allTextContents();
  expect(names.join() === run.motions.join(), `${told}: the motions are ${names}`);
  for (const [i, name] of [...run.motions.entries()].reverse()) {
    await page.locator("#motion").selectOption(String(i));
    const found = await shown();
    expect(found.name === name && found.canvases === 1 && found.charts > 3 && found.times > 10, `${told}: ${name} is shown as ${JSON.stringify(found)}`);
    const at = () => page.evaluate(() => window.proboscis.scene.parts.map((part) => Array.from(part.now).join()).join());
    const before = await at();
    await page.locator("#time").fill("300");
    expect((await at()) !== before, `${told}: the slider does not move ${name}`);
  }
  const values = await page.locator("#answer td").allTextContents();
  if (run.row) expect(values.some((value) => run.row.test(value)), `${told}: no constant among ${values}`);
}

/** The slider over a disturbance shows a motion of each size with and without feedback on the same axes, and the same reference. */
async function slide(page, run, told) {
  const slider = page.locator("input#size");
  await slider.scrollIntoViewIfNeeded();
  expect(await slider.inputValue() === String(run.sizes.indexOf(1)), `${told}: the slider begins at ${await slider.inputValue()}`);
  const seen = [];
  for (const [index, size] of run.sizes.entries()) {
    await slider.fill(String(index));
    await page.waitForTimeout(150);
    seen.push(await page.evaluate(() => {
      // A chart out of sight is not drawn; on paper all are.
      window.dispatchEvent(new Event("beforeprint"));
      const panels = window.proboscis.charts.made.filter((one) => one.size !== undefined);
      const ends = ({ min, max }) => [min, max].map((value) => Number(value.toPrecision(6)));
      const curve = ({ label, data }) => [label, JSON.stringify(data)];
      const found = {
        words: document.querySelector("output[for=size]").textContent,
        panels: panels.map(({ chart }) => ({ axes: JSON.stringify([ends(chart.scales.x), ends(chart.scales.y)]), curves: Object.fromEntries(chart.data.datasets.map(curve)), count: chart.data.datasets.length })),
      };
      window.dispatchEvent(new Event("afterprint"));
      return found;
    }));
    const { words, panels } = seen[index];
    expect(words === `${size} of the disturbance`, `${told}: the slider says ${words}`);
    expect(panels.length === 4 && panels.every(({ count }, i) => count === (i < 3 ? 3 : 2)), `${told}: ${panels.map(({ count }) => count)} curves`);
    if (!index) continue;
    const before = seen[index - 1].panels;
    for (const [i, { axes, curves }] of panels.entries()) {
      expect(axes === before[i].axes, `${told}: axes ${axes} after ${before[i].axes}`);
      expect(curves.reference === before[i].curves.reference, `${told}: another reference`);
      for (const name of ["with feedback", "without feedback"]) expect(curves[name] && curves[name] !== before[i].curves[name], `${told}: the same curve ${name} of ${size}`);
    }
  }
  // A key hides its curve, whatever size is shown.
  await slider.scrollIntoViewIfNeeded();
  await page.waitForFunction(() => window.proboscis.charts.made.find((one) => one.size !== undefined).chart);
  const key = page.locator("section[aria-label=Disturbance] .panel").first().locator("button", { hasText: "without feedback" });
  await key.click();
  const hidden = () => page.evaluate(() => window.proboscis.charts.made.find((one) => one.size !== undefined).chart.data.datasets.filter((one) => one.hidden).map((one) => one.label).join());
  expect((await hidden()) === "without feedback", `${told}: hidden is ${await hidden()}`);
  await slider.fill("0");
  await page.waitForTimeout(100);
  expect((await hidden()) === "without feedback", `${told}: hidden is ${await hidden()} after a step of the slider`);
  await key.click();
  await slider.fill(String(run.sizes.length - 1));
  await page.waitForTimeout(100);
  await page.locator("section[aria-label=Disturbance]").screenshot({ path: join(folder, `${told.replaceAll(" ", "-")}-slider.png`) });
}

const browser = await chromium.launch({ executablePath: PROGRAM, args: ARGUMENTS });
rmSync(folder, { recursive: true, force: true });
mkdirSync(join(folder, "scene"), { recursive: true });
writeFileSync(join(folder, "study.json"), JSON.stringify(STUDY));
writeFileSync(join(folder, "sweep.json"), JSON.stringify(SWEEP));
writeFileSync(join(folder, "scene", "swing.json"), JSON.stringify(SWING));
for (const run of RUNS.filter(({ name }) => !named.length || named.includes(name))) {
  const results = join(folder, run.name);
  for (const command of run.commands) {
    const words = command.map((word) => word.replace("FOLDER", folder));
    if (words[0] !== "new") words.push("-o", results, ...(words[0] === "report" ? [] : ["--quiet"]));
    execFileSync(binary, words, { stdio: ["ignore", "ignore", "inherit"] });
  }
  const file = resolve(results, "report.html");
  const size = readFileSync(file).length / 1e6;
  expect(size < run.megabytes, `${run.name}: a page of ${size} MB`);
  if (run.name === "elephant_trunk") fromCommandLine(file, run);
  for (const screen of SCREENS.filter((one) => !one.still || run.name === "elephant_trunk")) await look(browser, run, screen, file);
}
await browser.close();
console.log(`browser: ${passed} passed, ${failed} failed`);
process.exit(failed ? 1 : 0);
