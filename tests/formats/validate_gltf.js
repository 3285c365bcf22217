// Prints the Khronos validator's report on one file as JSON.
//     NODE_PATH=.../node_modules node validate_gltf.js FILE.glb
const { validateBytes } = require("gltf-validator");
const { readFileSync } = require("fs");

validateBytes(new Uint8Array(readFileSync(process.argv[2])), { maxIssues: 1000 }).then((report) =>
  console.log(JSON.stringify(report.issues)),
);
