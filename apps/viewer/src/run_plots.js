// Plots over frames; their cursor is the frame that is shown.
import uPlot from 'uplot';
import { color, digits, element, stretches, whenColorsChange } from './dom.js';

const column = (frames, key, scale = 1) =>
  frames.map((frame) => (frame[key] == null ? null : scale * frame[key]));
// A logarithmic axis has no place for 0.
const positive = (values) => values.map((value) => (value > 0 ? value : null));

function plotsOf(data) {
  const { frames } = data;
  const truth = frames.some((frame) => frame.error_mm != null);
  const particles = data.run.particles;
  const list = [
    { title: truth ? 'Position error' : 'Position uncertainty', unit: 'mm', log: true,
      series: [{ label: 'error', values: positive(column(frames, 'error_mm')), color: 'series-1' },
        { label: 'expected (1 σ)', values: positive(column(frames, 'sigma_mm')), color: 'series-2', band: true }] },
    { title: truth ? 'Rotation error' : 'Rotation uncertainty', unit: '°', log: true,
      series: [{ label: 'error', values: positive(column(frames, 'error_deg')), color: 'series-1' },
        { label: 'expected (1 σ)', values: positive(column(frames, 'sigma_deg')), color: 'series-2', band: true }] },
    { title: 'Agreement with the image', unit: '%', from0: 100,
      series: [{ label: 'agreement', values: column(frames, 'agreement', 100), color: 'series-2' },
        { label: 'score', values: column(frames, 'score', 100), color: 'series-1' },
        { label: 'effective particles', values: column(frames, 'effective_sample_size', 100 / particles), color: 'series-3' }] },
    { title: 'Time a frame', unit: 'ms', log: true,
      series: [{ label: 'time', values: positive(column(frames, 'time_ms')), color: 'series-1' }] },
  ];
  for (const plot of list) plot.series = plot.series.filter((one) => one.values.some((value) => value != null));
  return list.filter((plot) => plot.series.length > 0);
}

// Logarithmic axes label decades and, where few are shown, what lies between.
const logLabel = (u, values) => {
  const { min, max } = u.scales.y;
  const wide = Math.log10(max / min) > 2.2;
  return values.map((value) => {
    const first = Number(value.toExponential(0)[0]);
    return value != null && (first === 1 || (!wide && (first === 2 || first === 5))) ? String(Number(value.toPrecision(2))) : '';
  });
};

function logRange(u, low, high) {
  if (low == null) return [0.1, 10];
  return [Math.min(low * 0.75, high / 4), Math.max(high * 1.35, low * 4)];
}

export function axis(extra = {}) {
  return { stroke: color('muted'), font: '12px system-ui, sans-serif', labelFont: '12px system-ui, sans-serif',
    grid: { stroke: color('grid'), width: 1 }, ticks: { stroke: color('grid'), width: 1, size: 4 }, ...extra };
}

// A series with `low` and `high` has a band between them: two more columns, without lines.
const columnsOf = (plot) => plot.series.flatMap((one) => (one.low ? [one.values, one.high, one.low] : [one.values]));

function seriesOf(plot) {
  const bands = [];
  const list = [{ label: 'frame', value: (u, value) => (value == null ? '–' : String(value)) }];
  for (const one of plot.series) {
    const index = list.push({
      label: one.label, stroke: color(one.color), width: one.band ? 1.25 : 2, dash: one.band ? [5, 4] : undefined,
      fill: one.band ? `color-mix(in srgb, ${color(one.color)} 14%, transparent)` : undefined,
      fillTo: plot.log && one.band ? (u) => u.scales.y.min : undefined,
      points: { show: false }, value: (u, value) => (value == null ? '–' : `${digits(value)} ${plot.unit}`),
    }) - 1;
    if (!one.low) continue;
    for (const edge of ['high', 'low']) list.push({ label: `${one.label} ${edge}`, stroke: 'transparent', points: { show: false } });
    bands.push({ series: [index + 1, index + 2], fill: `color-mix(in srgb, ${color(one.color)} 15%, transparent)` });
  }
  return { series: list, bands };
}

// A curve goes with its band.
function showBand(chart, index, show) {
  const band = chart.bands.find(({ series: [high] }) => high === index + 1);
  for (const edge of band?.series ?? []) if (chart.series[edge].show !== show) chart.setSeries(edge, { show });
}

// Behind the curves, over half a frame to both sides.
function drawMarks(chart, marks) {
  const { ctx, bbox } = chart;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  const ids = chart.data[0];
  for (const { flags, color: name } of marks) {
    ctx.fillStyle = `color-mix(in srgb, ${color(name)} 20%, transparent)`;
    for (const [begin, end] of stretches(flags)) {
      const from = chart.valToPos(ids[begin] - 0.5, 'x', true), to = chart.valToPos(ids[end - 1] + 0.5, 'x', true);
      ctx.fillRect(from, bbox.top, to - from, bbox.height);
    }
  }
  ctx.restore();
}

function optionsOf(plot, width, height) {
  const yRange = plot.range ?? (plot.log ? logRange : [0, plot.from0 ?? null]);
  return {
    width, height, legend: { live: true }, padding: [8, 10, 0, 0],
    cursor: { sync: { key: 'frames', setSeries: false }, drag: { x: false, y: false }, points: { size: 7 }, y: false },
    scales: { x: { time: false }, y: { distr: plot.log ? 3 : 1, range: yRange } },
    axes: [axis({ size: 26, space: 60 }), axis({ size: plot.size ?? 46, ...(plot.log ? { values: logLabel, filter: (u, splits) => splits } : {}) })],
    ...seriesOf(plot),
  };
}

export class FramePlot {
  constructor(plot, ids, player) {
    Object.assign(this, { plot, ids, player });
    this.holder = element('div', { class: 'plot' });
    this.panel = element('figure', { class: 'panel plot-panel', role: 'group', 'aria-label': `${plot.title} over frames` },
      element('figcaption', {}, element('h2', {}, plot.title, element('small', {}, ` ${plot.unit}`))), this.holder);
  }

  build() {
    this.chart?.destroy();
    const width = Math.max(240, this.holder.clientWidth);
    // Positions are known once it is laid out.
    const hooks = { ready: [(chart) => { this.chart = chart; this.show(this.player.index); }],
      drawClear: [(chart) => drawMarks(chart, this.plot.marks ?? [])],
      setSeries: [(chart, index, { show }) => { if (index != null && show != null) showBand(chart, index, show); }] };
    this.chart = new uPlot({ ...optionsOf(this.plot, width, 190), hooks }, [this.ids, ...columnsOf(this.plot)], this.holder);
    const edges = new Set(this.chart.bands.flatMap((band) => band.series));
    this.chart.root.querySelectorAll('.u-legend .u-series').forEach((row, i) => { if (edges.has(i)) row.remove(); });
    this.now = element('div', { class: 'now' });
    const { over } = this.chart;
    over.append(this.now);
    const pick = (event) => {
      if (event.buttons === 1) this.player.show(this.chart.posToIdx(event.clientX - over.getBoundingClientRect().left));
    };
    over.addEventListener('pointerdown', pick);
    over.addEventListener('pointermove', pick);
    over.addEventListener('pointerleave', () => setTimeout(() => this.show(this.player.index), 0));
  }

  resize() {
    const width = this.holder.clientWidth;
    if (!this.chart || width < 100 || Math.abs(width - this.chart.width) < 2) return;
    this.chart.setSize({ width, height: 190 });
    this.show(this.player.index);
  }

  show(index) {
    if (this.chart?.status !== 1 || index < 0) return;
    this.now.style.transform = `translateX(${this.chart.valToPos(this.ids[index], 'x')}px)`;
    this.chart.setLegend({ idx: index });
  }
}

// Drawn once the page is laid out, and anew where colours or sizes change.
export function keepDrawn(plots, section, player) {
  const buildAll = () => plots.forEach((plot) => plot.build());
  requestAnimationFrame(buildAll);
  whenColorsChange(buildAll);
  new ResizeObserver(() => plots.forEach((plot) => plot.resize())).observe(section);
  window.addEventListener('beforeprint', () => plots.forEach((plot) => plot.resize()));
  player.onChange((index) => plots.forEach((plot) => plot.show(index)));
  return section;
}

// One panel a plot.
export function runPlots(data, player) {
  const ids = data.frames.map((frame) => frame.id);
  const plots = plotsOf(data).map((plot) => new FramePlot(plot, ids, player));
  return keepDrawn(plots, element('section', { class: 'plots', 'aria-label': 'Figures over frames' }, plots.map((plot) => plot.panel)), player);
}
