// The page on paper: light, as wide as a sheet, with all charts and a picture of the scene.

/** Draws everything for paper before the browser prints, and what it was afterwards. */
function printing(page) {
  const still = element("canvas", { id: "still", "aria-hidden": true });
  window.addEventListener("beforeprint", () => {
    page.scene?.canvas.after(still);
    page.scene?.picture.theme();
    page.scene?.still(still);
    page.charts.print(true);
  });
  window.addEventListener("afterprint", () => {
    still.remove();
    page.scene?.picture.theme();
    page.scene?.resize();
    page.charts.print(false);
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
