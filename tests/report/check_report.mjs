// A small simulated run, its report, and whether a browser shows it: node check_report.mjs NEARPOSE [CHROMIUM]
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { Browser } from './browser.mjs';

const [nearpose, chromium] = process.argv.slice(2);
const skip = (why) => { console.log(`skipped: ${why}`); process.exit(77); };
if (!chromium || chromium.endsWith('NOTFOUND')) skip('no chromium (Debian: chromium)');

// A name that would end the page's script, were it not escaped.
const folder = path.join(mkdtempSync(path.join(tmpdir(), 'nearpose_report_')), '<script>alert(1)<');
const run = (...words) => execFileSync(nearpose, [...words, '--quiet'], { stdio: ['ignore', 'inherit', 'inherit'] });

// camera_from_object by frame: rows of [R | t], metres, from the result file.
function posesOf(csv) {
  const rows = readFileSync(csv, 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
  return new Map(rows.map(([, frame, , , R, t]) => {
    const rotation = R.split(' ').map(Number), translation = t.split(' ').map((value) => Number(value) / 1e3);
    return [Number(frame), [0, 1, 2].flatMap((i) => [...rotation.slice(3 * i, 3 * i + 3), translation[i]])];
  }));
}

async function checkPose(browser, poses, frame) {
  await browser.until(`document.body.dataset.frame === '${frame}'`, `frame ${frame} is shown`);
  const shown = (await browser.evaluate('document.body.dataset.pose')).split(' ').map(Number);
  assert.equal(shown.length, 12);
  const expected = poses.get(frame);
  shown.forEach((value, i) => assert.ok(Math.abs(value - expected[i]) < 1e-4, `frame ${frame}: ${shown} is not ${expected}`));
  return shown;
}

// Share of the 3-D view's pixels that are not the background's colour.
const COVERED = `(() => {
  const stage = document.querySelector('.stage canvas');
  const canvas = new OffscreenCanvas(stage.width, stage.height);
  const context = canvas.getContext('2d');
  context.drawImage(stage, 0, 0);
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  let other = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (Math.abs(data[i] - data[0]) + Math.abs(data[i + 1] - data[1]) + Math.abs(data[i + 2] - data[2]) > 24) ++other;
  }
  return other / (data.length / 4);
})()`;

// Frames as the log describes them.
const loggedFrames = (jsonl) => readFileSync(jsonl, 'utf8').trim().split('\n').slice(1).map((line) => JSON.parse(line));

// Each frame shows the log's sentences, and the table counts what the log lacks.
async function checkVerdicts(browser, log) {
  const lacks = new Map();
  for (const { frame, verdict, missing } of log) {
    await browser.evaluate(`location.hash = "#frame=${frame}"`);
    await browser.until(`document.body.dataset.frame === '${frame}'`, `frame ${frame} is shown`);
    const shown = await browser.evaluate(`[...document.querySelectorAll('.missing:not([hidden]) li')].map((line) => line.textContent)`);
    assert.deepEqual(shown, missing.map(({ text }) => text), `frame ${frame}`);
    for (const name of [verdict, ...missing.map(({ requirement }) => requirement)]) lacks.set(name, [...lacks.get(name) ?? [], frame]);
  }
  assert.ok(log.some(({ missing }) => missing.length > 0) && log.some(({ verdict }) => verdict === 'accept'), 'frames of both kinds');
  const rows = await browser.evaluate(`[...document.querySelectorAll('.verdicts tbody tr')].map((row) => ({ name: row.dataset.row,
    cells: [...row.querySelectorAll('td')].slice(1).map((cell) => cell.textContent),
    bars: [...row.querySelectorAll('rect')].map((bar) => [bar.x.baseVal.value, bar.width.baseVal.value]) }))`);
  assert.deepEqual(new Set(rows.map(({ name }) => name)), new Set(lacks.keys()));
  for (const { name, cells: [count, share, first], bars } of rows) {
    const frames = lacks.get(name);
    assert.deepEqual([Number(count), Number(first)], [frames.length, frames[0]], name);
    assert.ok(Math.abs(Number.parseFloat(share) - 100 * frames.length / log.length) < 0.5, `${name}: ${share}`);
    assert.deepEqual(bars.flatMap(([begin, width]) => Array.from({ length: width }, (_, i) => begin + i)), frames, name);
  }
}

// Where the camera's poses are known, the part's place in the world is shown.
async function checkArm(browser) {
  const shown = await browser.evaluate(`({ plots: document.querySelectorAll('.arm-panel .uplot canvas').length,
    conclusions: [...document.querySelectorAll('.arm-panel .conclusion')].map((line) => line.textContent),
    legends: [...document.querySelectorAll('.arm-panel .u-legend')].map((legend) =>
      [...legend.querySelectorAll('.u-series')].map((row) => row.textContent)) })`);
  assert.equal(shown.plots, 2);
  assert.deepEqual(shown.conclusions, ['Nothing contradicts the arm.']);
  for (const [frame, ...axes] of shown.legends) {
    assert.match(frame, /^frame:?\d+$/);
    assert.deepEqual(axes.map((text) => text[0]), ['x', 'y', 'z'], 'bands have no legend of their own');
  }
}

// The page allows its own script and style by their hashes, and nothing else.
async function checkPolicy(browser, html) {
  const policy = /<meta http-equiv="Content-Security-Policy" content="([^"]*)">/.exec(html)[1];
  const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
  const between = (begin, end) => html.slice(html.lastIndexOf(begin) + begin.length, html.lastIndexOf(end));
  assert.ok(policy.includes(`script-src ${hash(between('<script>', '</script>'))}`), policy);
  assert.ok(policy.includes(`style-src ${hash(between('<style>', '</style>'))}`), policy);
  assert.doesNotMatch(policy, /unsafe|\*|https?:/);
  assert.equal(await browser.evaluate(`(() => { const added = document.createElement('script');
    added.textContent = 'window.injected = true'; document.body.append(added); return window.injected === true; })()`), false);
  for (let tries = 0; browser.problems.length === 0 && tries < 50; ++tries) await new Promise((done) => setTimeout(done, 100));
  assert.ok(browser.problems.length > 0 && browser.problems.every((text) => text.includes('Content Security Policy')), browser.problems.join());
}

async function check(browser, report, poses, log) {
  await browser.open(pathToFileURL(report).href);
  await browser.until(`document.body?.dataset.frame !== undefined && document.querySelectorAll('.uplot').length >= 4 &&
    document.querySelector('canvas.depth').dataset.frame !== undefined`, 'the page is built');
  const set = (index) => browser.evaluate(`(() => { const slider = document.getElementById('frame');
    slider.value = ${index}; slider.dispatchEvent(new Event('input')); })()`);
  await set(0);
  const first = await checkPose(browser, poses, 0);
  await set(3);
  const third = await checkPose(browser, poses, 3);
  assert.notDeepEqual(first, third, 'the slider does not move the pose');
  await browser.evaluate('document.activeElement?.blur()');
  await browser.key('ArrowRight');
  await checkPose(browser, poses, 4);
  await browser.evaluate('location.hash = "#frame=1"');
  await checkPose(browser, poses, 1);

  // The plots' cursors follow.
  const cursors = await browser.evaluate(`[...document.querySelectorAll('.u-legend .u-series:first-child .u-value')]
    .map((cell) => cell.textContent).join()`);
  assert.match(cursors, /^1(,1)*$/);

  await checkVerdicts(browser, log);
  await checkArm(browser);

  // The block alone covers a good part of the view, and nothing does once all is switched off.
  const toggles = (on) => browser.evaluate(`document.querySelectorAll('.view-panel .toggle input').forEach((box, i) => {
    if (box.checked !== (${on} && i === 0)) box.click(); })`);
  const settle = () => browser.evaluate('new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))');
  await toggles(true);
  await settle();
  const block = await browser.evaluate(COVERED);
  assert.ok(block > 0.03, `the model covers ${block} of the 3-D view`);
  await toggles(false);
  await settle();
  assert.equal(await browser.evaluate(COVERED), 0);
  assert.deepEqual(browser.problems, []);
  await checkPolicy(browser, readFileSync(report, 'utf8'));
}

let browser = null;
try {
  run('simulate', '--scenario', 'piston', '--seed', '1', '--frames', '6', '--out', folder);
  // A tolerance that the first frames do not meet and the later ones do.
  run('estimate', '--scene', `${folder}/test/000001`, '--models', `${folder}/models`, '--object', '1', '--run', `${folder}/run`,
    '--tolerance-mm', '1.5');
  const made = spawnSync(nearpose, ['report', `${folder}/run`, '--quiet'], { encoding: 'utf8' });
  if (made.status === 1 && made.stderr.includes('nodejs')) skip('the program was built without the viewer');
  assert.equal(made.status, 0, made.stderr);
  const report = `${folder}/run/report.html`;
  assert.ok(statSync(report).size < 2.5e6, `${statSync(report).size} bytes for 6 frames`);
  browser = new Browser(chromium, `${folder}/profile`);
  await check(browser, report, posesOf(`${folder}/run/poses.csv`), loggedFrames(`${folder}/run/log.jsonl`));
  console.log('the report opens, its slider moves the pose, and the block is seen');
} finally {
  await browser?.close();
  rmSync(path.dirname(folder), { recursive: true, force: true, maxRetries: 5 });
}
