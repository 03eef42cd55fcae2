// The figures of a run as text and tables.
import { digits, element } from './dom.js';

const name = (path) => path.split(/[\\/]/).filter(Boolean).pop() ?? path;

// What was run.
export function chips(run) {
  const chip = (label, value, title) => element('li', { title }, element('span', {}, label), ` ${value}`);
  return element('ul', { class: 'chips', 'aria-label': 'The run' },
    chip('method', run.method), chip('views', run.views), chip('particles', run.particles), chip('seed', run.seed),
    chip('start', run.initial_pose ? `around ${name(run.initial_pose)}` : 'without a prior pose'),
    chip('mask', run.mask ? 'used' : 'none'), chip('camera motion', run.motion ? 'used where measured' : 'not used'),
    chip('model', name(run.model), run.model));
}

function arrivalText(arrival) {
  if (arrival.first_frame == null) return ['never', ''];
  const stays = arrival.stays ? 'and stays there'
    : arrival.holds_from_frame == null ? 'but not in the last frame' : `for good from frame ${arrival.holds_from_frame}`;
  return [`frame ${arrival.first_frame}`, stays];
}

const within = (arrival) => `within ${arrival.within_mm} mm and ${+arrival.within_deg.toFixed(3)}°`;

function card(title, value, unit, text) {
  return element('div', { class: 'card' }, element('h3', {}, title),
    element('p', { class: 'value' }, value, unit && element('small', {}, ` ${unit}`)), element('p', { class: 'text' }, text));
}

export function cards({ figures }) {
  const list = [];
  if (figures.translation_mm) {
    const { translation_mm: t, rotation_deg: r, coarse, fine } = figures;
    const [value, text] = arrivalText(coarse);
    const [fineValue, fineText] = arrivalText(fine);
    list.push(card('Position error, median', digits(t.median), 'mm', `95 %: ${digits(t.percentile_95)} mm, largest ${digits(t.max)} mm`),
      card('Rotation error, median', digits(r.median), '°', `95 %: ${digits(r.percentile_95)}°, largest ${digits(r.max)}°`),
      card(`Found, ${within(coarse)}`, value, '', text),
      card(`Precise, ${within(fine)}`, fineValue, '', fineText));
  } else {
    list.push(card('Frames with the part seen', `${figures.estimated} of ${figures.frames}`, '', 'the true poses are not known: no errors are shown'));
  }
  const { verdicts } = figures;
  if (verdicts) list.push(card('Frames accepted', `${verdicts.accept} of ${verdicts.frames}`, '', `${verdicts.continue} continue, ${verdicts.lost} lost`));
  if (figures.time_ms) list.push(card('Time a frame, median', digits(figures.time_ms.median), 'ms', `95 %: ${digits(figures.time_ms.percentile_95)} ms`));
  return element('section', { class: 'cards', 'aria-label': 'Key figures' }, list);
}

function statisticsTable(figures) {
  const row = (label, unit, s) => s && element('tr', {}, element('th', { scope: 'row' }, label, element('small', {}, ` ${unit}`)),
    [s.mean, s.median, s.percentile_95, s.max].map((value) => element('td', {}, digits(value))));
  const axis = (i, key, label, unit) => row(`${label}, camera's ${'xyz'[i]}`, unit, figures.axes?.[i][key]);
  return element('table', {},
    element('thead', {}, element('tr', {}, element('th', {}), ['mean', 'median', '95 %', 'max'].map((text) => element('th', { scope: 'col' }, text)))),
    element('tbody', {}, row('position error', 'mm', figures.translation_mm),
      [0, 1, 2].map((i) => axis(i, 'translation_mm', 'along', 'mm')), row('rotation error', '°', figures.rotation_deg),
      [0, 1, 2].map((i) => axis(i, 'rotation_deg', 'about', '°')), row('surface distance (ADD-S)', 'mm', figures.add_s_mm),
      row('time a frame', 'ms', figures.time_ms)));
}

function list(rows) {
  return element('dl', { class: 'facts wide' }, rows.filter(Boolean).flatMap(([label, value]) => [element('dt', {}, label), element('dd', {}, value)]));
}

export function details({ run, figures, frames }) {
  const burnIn = figures.burn_in ? `Errors are of frames from ${frames[figures.burn_in]?.id} on. ` : '';
  const truthText = figures.translation_mm
    ? `${burnIn}Position errors are those of the centre of the part's box; symmetric parts are compared up to their symmetry. `
    : 'The true poses of this scene are not known. ';
  return element('section', { class: 'details' },
    element('div', { class: 'panel' }, element('h2', {}, 'Figures'), statisticsTable(figures), element('p', { class: 'note' },
      `${truthText}The dashed lines are what the estimator itself expects of its error (one standard deviation of its covariance).`)),
    element('div', { class: 'panel' }, element('h2', {}, 'Run'), list([
      ['frames', `${figures.frames}: ${figures.estimated} estimated, ${figures.predicted} predicted, ${figures.without_pose} without a pose`],
      figures.lost != null && ['lost after it was found', `${figures.lost} frames`],
      figures.inside_90 != null && ['truth inside the 90 % region', `${digits(100 * figures.inside_90)} % of frames`],
      ['input', run.input], ['model', `${run.model}, object ${run.object}`],
      ['program', Object.entries(run.program).map(([key, value]) => `${key} ${value}`).join(', ')]]),
    element('p', { class: 'note' }, 'Space plays, ← and → step; click a plot to go to its frame; #frame=12 in the address opens one. Contains three.js and uPlot (MIT licence, texts in the source of this file).')));
}
