// Why frames were not accepted: the sentences of the frame that is shown, and which frames lacked what.
import { digits, drawing, element, stretches } from './dom.js';

// The sentences are the log's.
export function missingList(data, player) {
  const list = element('ul', { class: 'missing', 'aria-label': 'What is missing to accept the pose', 'aria-live': 'polite' });
  player.onChange((index) => {
    const missing = data.frames[index].missing ?? [];
    list.hidden = missing.length === 0;
    list.replaceChildren(...missing.map(({ text }) => element('li', {}, text)));
  });
  return list;
}

// One place a frame, coloured where `flags` is set; shows the frame that is clicked.
function strip(flags, kind, label, player) {
  const count = flags.length;
  const now = element('div', { class: 'now' });
  const bars = stretches(flags).map(([begin, end]) => drawing('rect', { class: kind, x: begin, y: 0, width: end - begin, height: 1 }));
  const pick = (event) => {
    if (event.buttons !== 1) return;
    const box = holder.getBoundingClientRect();
    player.show(Math.floor(count * (event.clientX - box.left) / box.width));
  };
  const holder = element('div', { class: 'strip', role: 'img', 'aria-label': label, pointerdown: pick, pointermove: pick },
    drawing('svg', { viewBox: `0 0 ${count} 1`, preserveAspectRatio: 'none', 'aria-hidden': 'true' }, bars), now);
  player.onChange((index) => { now.style.left = `calc(${100 * (index + 0.5) / count}% - 1px)`; });
  return holder;
}

function rowsOf({ frames, figures: { verdicts } }) {
  const verdictRow = (verdict) => ({ title: verdict, kind: verdict, count: verdicts[verdict], of: (frame) => frame.verdict === verdict });
  const lackRow = ({ requirement, title, advice, frames: count }) => ({ title: `lacks ${title}`, advice, kind: 'lack', requirement, count,
    of: (frame) => frame.missing?.some((lack) => lack.requirement === requirement) ?? false });
  return [...['accept', 'continue', 'lost'].map(verdictRow), ...verdicts.lacks.map(lackRow)]
    .filter(({ count }) => count > 0).map((row) => ({ ...row, flags: frames.map(row.of) }));
}

// Nothing where the log has no verdicts.
export function verdictPanel(data, player) {
  const { verdicts } = data.figures;
  if (!verdicts) return null;
  const rows = rowsOf(data).map(({ title, advice, kind, requirement, count, flags }) => {
    const first = data.frames[flags.indexOf(true)].id;
    return element('tr', { 'data-row': requirement ?? kind },
      element('th', { scope: 'row' }, title, advice && element('small', {}, advice)),
      element('td', { class: 'over-frames' }, strip(flags, kind, `${title}: ${count} of ${verdicts.frames} frames`, player)),
      element('td', {}, String(count)), element('td', {}, `${digits(100 * count / verdicts.frames)} %`),
      element('td', {}, element('a', { href: `#frame=${first}` }, String(first))));
  });
  return element('section', { class: 'panel verdict-panel', 'aria-label': 'Verdicts' },
    element('h2', {}, 'Verdicts, and what is missing to accept'),
    element('div', { class: 'scroll' }, element('table', { class: 'verdicts' },
      element('thead', {}, element('tr', {}, element('th', {}), element('th', { scope: 'col', class: 'over-frames' }, 'over frames'),
        ['frames', 'share', 'first'].map((text) => element('th', { scope: 'col' }, text)))),
      element('tbody', {}, rows))));
}
