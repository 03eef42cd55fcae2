// Arm and eye: where each frame puts the part in the world, and what was concluded of the arm.
import { FramePlot, keepDrawn } from './run_plots.js';
import { element } from './dom.js';

const EVENTS = [['contradicted', 'image and arm contradict each other', 'series-6'], ['cause', 'the part seems to move: a cause is found', 'series-5'],
  ['motion', 'the image moves otherwise than the arm', 'series-4'], ['repeated', 'the image is the one before', 'muted']];
const AXES = [['x', 'series-1'], ['y', 'series-2'], ['z', 'series-3']];

// What accepted frames need, and of the others what nine of ten do: a pose that was wrong at first hides nothing.
function rangeOf(data, value, sigma, least) {
  const ends = [];
  data.arm.frames.forEach((frame, i) => {
    if (!frame) return;
    const low = Math.min(...frame[value].map((v, axis) => v - frame[sigma][axis]));
    const high = Math.max(...frame[value].map((v, axis) => v + frame[sigma][axis]));
    ends.push({ low, high, size: Math.max(-low, high), accepted: data.frames[i].verdict === 'accept' });
  });
  const others = ends.filter(({ accepted }) => !accepted).sort((a, b) => a.size - b.size);
  const shown = [...ends.filter(({ accepted }) => accepted), ...others.slice(0, Math.ceil(0.9 * others.length))];
  const low = Math.min(-least, ...shown.map((end) => end.low)), high = Math.max(least, ...shown.map((end) => end.high));
  return [low - 0.06 * (high - low), high + 0.06 * (high - low)];
}

function plotOf(data, title, unit, value, sigma, least) {
  const column = (one) => data.arm.frames.map((frame) => (frame ? one(frame) : null));
  return { title, unit, size: 52, range: rangeOf(data, value, sigma, least),
    marks: EVENTS.map(([event, , color]) => ({ color, flags: data.arm.events.map((one) => one === event) })),
    series: AXES.map(([label, color], axis) => ({ label, color, values: column((frame) => frame[value][axis]),
      low: column((frame) => frame[value][axis] - frame[sigma][axis]), high: column((frame) => frame[value][axis] + frame[sigma][axis]) })) };
}

function legend(events) {
  const present = EVENTS.filter(([event]) => events.includes(event));
  return element('div', { class: 'toggles' }, present.map(([event, text, color]) => element('span', { class: 'toggle', 'data-event': event },
    element('i', { class: 'swatch', style: `background: color-mix(in srgb, var(--${color}) 35%, transparent)`, 'aria-hidden': 'true' }), text)));
}

// Nothing where the log has no pose of the camera.
export function armPanel(data, player) {
  const { arm } = data;
  if (!arm) return null;
  const ids = data.frames.map((frame) => frame.id);
  const plots = [plotOf(data, 'Place of its centre, from the median', 'mm', 'shift_mm', 'sigma_mm', 1),
    plotOf(data, 'Turn, from the median', '°', 'turn_deg', 'sigma_deg', 0.25)].map((plot) => new FramePlot(plot, ids, player));
  const place = arm.centre_m.map((metres, axis) => `${'xyz'[axis]} ${(1e3 * metres).toFixed(1)}`).join(', ');
  const section = element('section', { class: 'panel arm-panel', 'aria-label': 'Arm and eye' },
    element('figcaption', {}, element('h2', {}, 'Arm and eye', element('small', {}, ' the part in the world')), legend(arm.events)),
    arm.conclusions.map((text) => element('p', { class: 'conclusion' }, text)),
    element('div', { class: 'plots' }, plots.map((plot) => plot.panel)),
    element('p', { class: 'note' }, `A part that stands still keeps its place while the camera moves. Median place of its centre: ${place} mm. Bands are ±1 σ: of the pose, and of an arm and a hand-eye calibration as they should be. Axes are the world's.`));
  return keepDrawn(plots, section, player);
}
