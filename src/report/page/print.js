// The page on paper: light, as wide as a sheet, with all charts and a picture of the scene.

/** Draws everything for paper before the browser prints, and what it was afterwards. */
function printing({ scene, charts }) {
  const still = element("canvas", { id: "still", "aria-hidden": true });
  window.addEventListener("beforeprint", () => {
    scene?.canvas.after(still);
    scene?.picture.theme();
    scene?.still(still);
    charts.print(true);
  });
  window.addEventListener("afterprint", () => {
    still.remove();
    scene?.picture.theme();
    scene?.resize();
    charts.print(false);
  });
}

/** Keeps the page from being loaded, after which a browser may print it, until it is drawn; returns what ends that. */
function unloaded() {
  const waiting = element("iframe", { hidden: "", title: "" });
  document.body.append(waiting);
  waiting.contentDocument.open();
  return () => {
    waiting.contentDocument.close();
    waiting.remove();
  };
}
