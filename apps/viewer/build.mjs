// Bundles the page's script and style sheet: node build.mjs SOURCE_FOLDER OUT_FOLDER
// Runs where node_modules is (the build folder); the sources stay where they are.
import { readFileSync } from 'node:fs';
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
