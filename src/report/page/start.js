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
  const view = document.getElementById("view");
  const branch = data.scene?.branch;
  const fractions = branch ? numbers(branch.fractions) : null;
  const [first, last] = branch ? [0, fractions.length - 1] : data.scene?.span || data.span || [0, 0];
  const moves = last > first;
  const clock = new Clock(first, last, fractions);
  const page = { clock };
  if (!data.scene) {
    view.remove();
    document.getElementById("first").classList.add("plain");
  } else try {
    page.scene = new Scene(data.scene, view);
    options(page.scene, document.getElementById("options"), view);
    clock.listen((time) => page.scene.set(time));
  } catch (error) {
    view.replaceChildren(element("p", { id: "failure" }, `The robot cannot be drawn here: ${error.message}. configuration.svg shows it.`));
  }
  if (moves) player(clock, document.getElementById("player"));
  page.charts = new Charts(data.charts, document.getElementById("charts"), clock);
  dark.addEventListener("change", () => {
    page.scene?.picture.theme();
    page.scene?.draw();
  });
  // The end of the motion is what was asked for, of a path where stability is lost.
  clock.set(branch ? branch.shown : clock.last);
  printing(page);
  window.proboscis = page;
}

const drawnAll = unloaded();
start().catch((error) => {
  console.error(error);
  document.querySelector("main").prepend(element("p", { id: "failure" }, `This page could not be drawn: ${error.message}`));
}).finally(drawnAll);
