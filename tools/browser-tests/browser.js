// Opens reports in Chromium.
import { chromium } from "playwright-core";
import { pathToFileURL, fileURLToPath } from "node:url";
import path from "node:path";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");

// Where the sample reports are.
export const samples = process.env.REPORT_SAMPLES || path.join(root, "target/report-samples");

// Where the real ones are.
export const real = process.env.REPORT_REAL || path.join(root, "target/report-real");

export const launch = () => chromium.launch({
  executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
  args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});

// A page with a report, a sample unless a folder is given, and what went wrong on it.
export async function open(browser, name, { folder = samples, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, ...options });
  // On a machine that does much else a page takes its time.
  context.setDefaultTimeout(120000);
  const page = await context.newPage();
  const troubles = [];
  // The tests read pixels back, the page does not.
  page.on("console", message => { if (["error", "warning"].includes(message.type()) && !/willReadFrequently/.test(message.text())) troubles.push(message.text()); });
  page.on("pageerror", error => troubles.push(String(error)));
  page.on("dialog", dialog => { troubles.push("dialog: " + dialog.message()); dialog.dismiss(); });
  page.on("request", request => { if (!/^(file|data|blob):/.test(request.url())) troubles.push("request: " + request.url()); });
  await page.goto(pathToFileURL(path.join(folder, name + ".html")).href);
  if (options.javaScriptEnabled !== false) await page.waitForFunction(() => window.report && window.report.ready);
  return { page, troubles, close: () => context.close() };
}
