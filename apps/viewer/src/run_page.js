// The page about one run.
import { View3d } from './view3d.js';
import { RESIDUAL_RANGE_MM } from './view_parts.js';
import { DepthView } from './depth_view.js';
import { runPlots } from './run_plots.js';
import { armPanel } from './arm_panel.js';
import { Player, listenToKeys } from './player.js';
import { choice, digits, element, toggle } from './dom.js';
import { depthColor, gradient, residualColor } from './ramps.js';
import { cards, chips, details } from './run_figures.js';
import { missingList, verdictPanel } from './verdicts.js';

function transport(data, player) {
  const last = data.frames.length - 1;
  const slider = element('input', { type: 'range', id: 'frame', min: 0, max: last, value: 0, step: 1, 'aria-label': 'Frame',
    input: (event) => player.show(Number(event.target.value)) });
  const button = element('button', { type: 'button', class: 'play', 'aria-label': 'Play', title: 'Play (space)', click: () => player.toggle() });
  const label = element('output', { for: 'frame', class: 'frame-label' });
  player.playChanged = () => {
    button.classList.toggle('playing', player.playing);
    button.setAttribute('aria-label', player.playing ? 'Pause' : 'Play');
  };
  player.onChange((index) => {
    const frame = data.frames[index];
    slider.value = index;
    slider.setAttribute('aria-valuetext', `frame ${frame.id}`);
    label.replaceChildren(element('b', {}, `Frame ${frame.id}`), ` of ${data.frames[last].id}`);
  });
  return element('div', { class: 'transport' }, button, slider, label);
}

const STATUS = { estimated: 'estimated', predicted: 'predicted, the part is not seen', no_pose: 'no pose yet' };

// Where the arm's poses put the part's centre.
function placed({ arm }, index) {
  const place = arm?.frames[index];
  return place && `${place.shift_mm.map((shift, axis) => (1e3 * arm.centre_m[axis] + shift).toFixed(1)).join(', ')} mm`;
}

function facts(data, player) {
  const list = element('dl', { class: 'facts' });
  player.onChange((index) => {
    const frame = data.frames[index];
    const distance = frame.pose && 1e3 * Math.hypot(...frame.pose.slice(0, 3));
    const rows = [['state', frame.unread ? 'not read' : STATUS[frame.status] ?? frame.status],
      frame.verdict && ['verdict', frame.verdict],
      frame.error_mm != null && ['position error', `${digits(frame.error_mm)} mm`],
      frame.error_deg != null && ['rotation error', `${digits(frame.error_deg)}°`],
      frame.sigma_mm != null && ['expected (1 σ)', `${digits(frame.sigma_mm)} mm, ${digits(frame.sigma_deg)}°`],
      distance && ['distance of its origin', `${digits(distance)} mm`],
      placed(data, index) && ['its centre in the world', placed(data, index)],
      frame.agreement != null && ['agreement', `${digits(100 * frame.agreement)} %`],
      frame.score != null && ['score', `${digits(100 * frame.score)} %`],
      frame.time_ms != null && ['time', `${digits(frame.time_ms)} ms`]];
    list.replaceChildren(...rows.filter(Boolean).flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]));
  });
  return list;
}

function coloringScale() {
  const scale = element('div', { class: 'scale view-scale' });
  const show = (coloring) => {
    const residual = coloring === 'residual';
    scale.replaceChildren(residual ? `${RESIDUAL_RANGE_MM} mm in front of the model` : 'near',
      element('i', { style: `background: ${residual ? gradient(residualColor, -1, 1) : gradient(depthColor)}`, 'aria-hidden': 'true' }),
      residual ? `${RESIDUAL_RANGE_MM} mm behind it` : 'far');
  };
  show('depth');
  return { scale, show };
}

// The 3-D panel; `view` is missing where the browser has no WebGL.
function viewPanel(data) {
  const stage = element('div', { class: 'stage' });
  const panel = element('figure', { class: 'panel view-panel' });
  let view = null;
  const set = (name) => (value) => view?.set(name, value);
  const { scale, show } = coloringScale();
  const has = (key) => data.frames.some((frame) => frame[key] != null);
  panel.append(
    element('figcaption', {}, element('h2', {}, 'Pose'),
      choice('View', [['free', 'Free'], ['camera', 'From the camera']], 'free', set('view')),
      choice('Hold still', [['part', 'Part'], ['camera', 'Camera']], 'part', set('hold')),
      choice('Colour', [['depth', 'Depth'], ['residual', 'Residual']], 'depth', (value) => { show(value); view?.set('coloring', value); })),
    stage,
    element('div', { class: 'toggles' },
      toggle('Model', true, set('model'), 'model'), toggle('Measured', true, set('cloud'), 'measured'),
      toggle('Surroundings', true, set('around'), 'around'),
      has('particles_float32') && toggle('Particles', true, set('particles'), 'particles'),
      has('truth') && toggle('Truth', false, set('truth'), 'truth'),
      toggle('Camera', true, set('camera'), 'camera'),
      element('button', { type: 'button', class: 'plain', click: () => view?.reset() }, 'Reset view'), scale));
  return { panel, start() {
    try {
      view = new View3d(stage, data);
    } catch (error) {
      stage.append(element('p', { class: 'failure' }, `The 3-D view needs WebGL, which this browser does not give: ${error.message}`));
    }
    return view;
  } };
}

// For links to a frame (#frame=12) and for whoever tests the page.
function publish(data, player, view) {
  const fromAddress = () => {
    const id = /frame=(\d+)/.exec(location.hash)?.[1];
    return id == null ? -1 : data.frames.findIndex((frame) => frame.id === Number(id));
  };
  player.onChange((index) => {
    document.body.dataset.frame = data.frames[index].id;
    const pose = view?.shownPose();
    document.body.dataset.pose = pose ? pose.join(' ') : '';
  });
  window.addEventListener('hashchange', () => { if (fromAddress() >= 0) player.show(fromAddress()); });
  const settled = Math.max(0, data.frames.findLastIndex?.((frame) => frame.status === 'estimated') ?? 0);
  return fromAddress() >= 0 ? fromAddress() : Math.min(settled, Math.floor(0.4 * data.frames.length));
}

export function showRun(page, data) {
  const player = new Player(data.frames.length);
  const depth = new DepthView(data.frames);
  const { panel, start } = viewPanel(data);
  page.append(
    element('header', {}, element('div', { class: 'title' }, element('h1', {}, data.title), element('p', { class: 'brand' }, 'nearpose report')), chips(data.run)),
    cards(data),
    element('section', { class: 'scene', 'aria-label': 'Frames' }, panel,
      element('div', { class: 'aside' }, depth.panel, element('div', { class: 'panel' }, facts(data, player), missingList(data, player))),
      element('div', { class: 'panel transport-panel' }, transport(data, player))),
    ...[verdictPanel(data, player), armPanel(data, player)].filter(Boolean),
    runPlots(data, player),
    details(data));
  const view = start();
  if (view) player.onChange((index) => view.show(index));
  player.onChange((index) => depth.show(index));
  const first = publish(data, player, view);
  player.show(first);
  listenToKeys(player);
}
