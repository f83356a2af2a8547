// Runs the Khronos glTF validator: node validate_gltf.mjs FILE...
//
// Prints one line for each finding and exits with 1 on any error, warning, or information that is
// not expected. Expected are: UNSUPPORTED_EXTENSION for LIMBER_mesh_ik (the validator does not know
// it), UNUSED_OBJECT for exactly the accessors that the extension owns, and for texture coordinates
// of a mesh without a texture. Exits with 2 when there is
// nothing to validate or no validator.
import { readFile } from 'node:fs/promises';
import { dirname, resolve } from 'node:path';

const extensionName = 'LIMBER_mesh_ik';
const severities = ['error', 'warning', 'information', 'hint'];

let validator;
try {
  validator = (await import('gltf-validator')).default;
} catch {
  console.error('gltf-validator is not installed; run: npm install --prefix tests');
  process.exit(2);
}

function jsonOf(bytes) {
  const isGlb = bytes.length >= 20 && bytes.toString('latin1', 0, 4) === 'glTF';
  const text = isGlb ? bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)) : bytes.toString('utf8');
  return JSON.parse(text);
}

// JSON pointers of the accessors that belong to the extension's tables.
function ownedAccessors(root) {
  const owned = new Set();
  for (const rig of root.extensions?.[extensionName]?.rigs ?? []) {
    for (const table of Object.values(rig.tables ?? {})) owned.add(`/accessors/${table.accessor}`);
  }
  return owned;
}

function isExpected(message, root, owned) {
  if (message.code === 'UNSUPPORTED_EXTENSION') {
    const index = Number(message.pointer.split('/').pop());
    return root.extensionsUsed?.[index] === extensionName;
  }
  return message.code === 'UNUSED_OBJECT' &&
      (owned.has(message.pointer) || /\/attributes\/TEXCOORD_\d+$/.test(message.pointer));
}

async function validate(file) {
  const bytes = await readFile(file);
  const report = await validator.validateBytes(new Uint8Array(bytes), {
    uri: file,
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(resolve(dirname(file), decodeURIComponent(uri)))),
  });
  const root = jsonOf(bytes);
  const owned = ownedAccessors(root);
  const unexpected = report.issues.messages.filter(
      (message) => message.severity < 3 && !isExpected(message, root, owned));
  for (const message of unexpected) {
    console.log(`${file}: ${message.pointer ?? ''}: ${severities[message.severity]}: ` +
                `${message.code}: ${message.message}`);
  }
  const unusedTables = report.issues.messages.filter(
      (message) => message.code === 'UNUSED_OBJECT' && owned.has(message.pointer)).length;
  if (unusedTables !== owned.size) {
    console.log(`${file}: ${owned.size} tables, but ${unusedTables} accessors are reported unused`);
  }
  return unexpected.length === 0 && unusedTables === owned.size;
}

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate_gltf.mjs FILE...');
  process.exit(2);
}
let good = true;
for (const file of files) good = (await validate(file)) && good;
if (good) console.log(`${files.length} files: no error, no warning`);
process.exit(good ? 0 : 1);
