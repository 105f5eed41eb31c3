// Draws a Vega-Lite specification: node render.mjs MODULES SPEC.vl.json OUT.svg
// MODULES is the folder whose node_modules holds vega and vega-lite (npm ci with the package-lock.json beside this file).
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';

const [modules, specFile, svgFile] = process.argv.slice(2);
const require = createRequire(join(modules, 'package.json'));
const vega = require('vega');
const vegaLite = require('vega-lite');

// Warnings are mistakes in the specification, e.g. a misspelt channel that would leave the figure without it.
const problems = [];
const logger = {
  level() { return this; },
  error(...text) { problems.push(text.join(' ')); return this; },
  warn(...text) { problems.push(text.join(' ')); return this; },
  info() { return this; },
  debug() { return this; },
};

const spec = JSON.parse(readFileSync(specFile, 'utf8'));
const compiled = vegaLite.compile(spec, { logger }).spec;
const view = new vega.View(vega.parse(compiled), { renderer: 'none', logger });
const svg = await view.toSVG();
if (problems.length > 0) {
  console.error(problems.join('\n'));
  process.exit(1);
}
writeFileSync(svgFile, svg);
