// Puts the page together.

async function start() {
  const data = JSON.parse(document.getElementById("data").textContent);
  document.getElementById("system").textContent = data.system;
  document.getElementById("kind").textContent = data.title;
  if (data.names) compared(data, document.getElementById("answer"));
  else answer(data, document.getElementById("answer"));
  again(data, document.getElementById("answer"));
  tables(data, document.getElementById("tables"));
  await unpack("three");
  await unpack("chart");
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  const page = {};
  if (!data.scenes.length) document.getElementById("first").classList.add("plain");
  if (data.scenes.length > 1) motions(data, page);
  show(data, page, 0);
  dark.addEventListener("change", () => {
    page.scene?.picture.theme();
    page.scene?.draw();
    page.charts.renew();
  });
  printing(page);
  window.proboscis = page;
}

/** The motions that the reader chooses from. */
function motions(data, page) {
  const select = element("select", { id: "motion" }, ...data.scenes.map(({ name }, i) => element("option", { value: i }, name)));
  select.addEventListener("change", () => show(data, page, select.value));
  document.getElementById("view").before(element("div", { id: "motions", class: "bar" }, element("label", {}, data.names ? "result" : "motion", select)));
}

/** Shows a motion, if there is any, in place of the one before: its scene with its clock, its charts and those of all. */
function show(data, page, chosen) {
  const [view, bar, choices, charts] = ["view", "player", "options", "charts"].map((id) => document.getElementById(id));
  page.clock?.play(false);
  page.scene?.leave();
  page.charts?.leave();
  for (const holder of [view, bar, choices, charts]) holder.replaceChildren();
  const scene = data.scenes[chosen];
  const branch = scene?.branch;
  const fractions = branch ? numbers(branch.fractions) : null;
  const [first, last] = branch ? [0, fractions.length - 1] : data.span || scene?.span || [0, 0];
  const clock = new Clock(first, last, fractions);
  Object.assign(page, { clock, scene: null });
  if (scene) try {
    page.scene = new Scene(scene, view);
    options(page.scene, choices, view);
    clock.listen((time) => page.scene?.set(time));
  } catch (error) {
    page.scene = null;
    view.replaceChildren(element("p", { id: "failure" }, `The robot cannot be drawn here: ${error.message}. configuration.svg shows it.`));
  }
  if (last > first) player(clock, bar);
  page.charts = new Charts(data.charts.filter(({ of }) => !of || of === scene.name), charts, clock);
  // The end of the motion is what was asked for, of a path where stability is lost.
  clock.set(branch ? branch.shown : clock.last);
}

const drawnAll = unloaded();
start().catch((error) => {
  console.error(error);
  document.querySelector("main").prepend(element("p", { id: "failure" }, `This page could not be drawn: ${error.message}`));
}).finally(drawnAll);
