// The folder of the public data, and how a test says that it is skipped without them (tools/public_data.rs for those in Rust).
import { appendFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";

// UNDRIFT_DATA, by default ../shared/data beside the project; a relative path starts at the project's root.
const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
export const publicData = path.resolve(root, process.env.UNDRIFT_DATA || "../shared/data");

// Reports a test as skipped, in the file UNDRIFT_SKIPPED too; gives the reason for the test runner.
export function skipped(test, without) {
  if (process.env.UNDRIFT_SKIPPED) appendFileSync(process.env.UNDRIFT_SKIPPED, `skipped: browser::${test} without ${without}\n`);
  return `without ${without}`;
}
