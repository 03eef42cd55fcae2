// Bundles the page's script and style sheet, and writes the policy that allows these two: node build.mjs SOURCE_FOLDER OUT_FOLDER
// Runs where node_modules is (the build folder); the sources stay where they are.
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import esbuild from 'esbuild';

const [source, out] = process.argv.slice(2);
const modules = path.resolve('node_modules');

// What is bundled goes on with the page, and its licences with it.
const licences = ['three', 'uplot'].map((name) => {
  const { version } = JSON.parse(readFileSync(path.join(modules, name, 'package.json'), 'utf8'));
  return `${name} ${version}\n\n${readFileSync(path.join(modules, name, 'LICENSE'), 'utf8').trim()}`;
});

await esbuild.build({
  entryPoints: { viewer: path.join(source, 'main.js') },
  outdir: out,
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2020',
  nodePaths: [modules],
  legalComments: 'none', // the whole texts stand in the banner
  banner: { js: `/*! This page contains:\n\n${licences.join('\n\n')}\n*/` },
  logLevel: 'warning',
});

// What the page may do (its Content-Security-Policy): run this script, use this style, and show images that it holds.
// Texts of other people's files that got into it as markup could do nothing.
const hash = (file) => `'sha256-${createHash('sha256').update(readFileSync(path.join(out, file))).digest('base64')}'`;
writeFileSync(path.join(out, 'viewer.policy'), ["default-src 'none'", `script-src ${hash('viewer.js')}`,
  `style-src ${hash('viewer.css')}`, 'img-src data:', "base-uri 'none'", "form-action 'none'"].join('; '));
