// Pictures per second while a page plays: `node playback.js BINARY FOLDER [PAGE]`, of a block of 1024 elements where no page is named.
// A measurement for a person to read, no test: other work on the machine shows in it. Processor time of a picture is that of all processes.

import { execFileSync } from "node:child_process";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [binary, folder, named] = process.argv.slice(2);
const SECONDS = 5;
const SCREENS = [{ width: 1400, height: 900 }, { width: 400, height: 800 }];

/** The page of a stack of 8 x 8 x 16 elements that contracts under a voltage. */
function block() {
  const results = join(folder, "playback");
  execFileSync(binary, ["simulate", "problems/clamped_stack_step.json", "--set", "scene.solids[0].box.elements=[8,8,16]", "-o", results, "--quiet"], { stdio: ["ignore", "ignore", "inherit"] });
  return join(results, "report.html");
}

const file = pathToFileURL(resolve(named || block())).href;
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM || "/usr/bin/chromium", args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
const processes = await browser.newBrowserCDPSession();
const processor = async () => (await processes.send("SystemInfo.getProcessInfo")).processInfo.reduce((sum, one) => sum + one.cpuTime, 0);
for (const screen of SCREENS) {
  const page = await browser.newPage({ viewport: screen });
  await page.goto(file);
  await page.waitForFunction(() => window.proboscis?.charts, null, { timeout: 180000 });
  await page.waitForTimeout(1000);
  const drawn = () => page.evaluate(() => window.proboscis.scene.picture.renderer.info.render.frame);
  await page.evaluate(() => window.proboscis.clock.play(true));
  await page.waitForTimeout(1000);
  const [count, time, seconds] = [await drawn(), await processor(), performance.now()];
  await page.waitForTimeout(1000 * SECONDS);
  const pictures = (await drawn()) - count;
  const per = [pictures / ((performance.now() - seconds) / 1000), ((await processor()) - time) * (1000 / pictures)];
  const size = await page.evaluate(() => `${window.proboscis.scene.canvas.width} x ${window.proboscis.scene.canvas.height}`);
  console.log(`${screen.width} x ${screen.height}: ${per[0].toFixed(0)} pictures per second, ${per[1].toFixed(0)} ms of processor time each, of ${size} pixels`);
  await page.close();
}
await browser.close();
