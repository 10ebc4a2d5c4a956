// Pictures of the demo's report for the documentation: `node screenshots.js DIR`, where DIR/demo.html is.
import { mkdir } from "node:fs/promises";
import path from "node:path";
import { launch, open } from "./browser.js";

const folder = path.resolve(process.argv[2]);
const images = path.resolve(import.meta.dirname, "../../docs/img");
await mkdir(images, { recursive: true });
const browser = await launch();

async function picture(name, colorScheme, clip) {
  const { page, close } = await open(browser, "demo", { folder, colorScheme, viewport: { width: 1200, height: 900 } });
  const { y, height } = await clip(page);
  await page.screenshot({ path: path.join(images, name), fullPage: true, clip: { x: 0, y, width: 1200, height } });
  await close();
}

const bottom = (page, selector) => page.evaluate(selector => document.querySelector(selector).getBoundingClientRect().bottom + scrollY, selector);
const top = (page, selector) => page.evaluate(selector => document.querySelector(selector).getBoundingClientRect().top + scrollY, selector);
const head = async page => ({ y: 0, height: Math.ceil(await bottom(page, "#table-1")) + 16 });
const spread = async page => { const y = Math.floor(await top(page, "#figure-2")) - 8; return { y, height: Math.ceil(await bottom(page, "#figure-3")) + 16 - y }; };

await picture("report-demo.png", "light", head);
await picture("report-demo-dark.png", "dark", head);
await picture("report-outages.png", "light", spread);
await browser.close();
