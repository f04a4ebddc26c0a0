// Khronos glTF validator on the files of the command line; prints one JSON object a file name.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const validator = createRequire(import.meta.url)("gltf-validator");
const reports = {};
for (const name of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(name)));
  reports[name] = { ...report.issues, info: report.info };
}
console.log(JSON.stringify(reports));
