// Curves with bands: medians, and between which quarter and which the values lie.
import uPlot from 'uplot';
import { axis } from './run_plots.js';
import { color, digits, element, whenColorsChange } from './dom.js';

const COLORS = ['series-1', 'series-2', 'series-3', 'series-4', 'series-5', 'series-6'];
const HEIGHT = 320;

// All curves on the x values of all of them.
function aligned(curves) {
  const xs = [...new Set(curves.flatMap((curve) => curve.x))].sort((a, b) => a - b);
  const onto = (curve, key) => {
    const value = new Map(curve.x.map((x, i) => [x, curve[key][i]]));
    return xs.map((x) => (value.has(x) ? value.get(x) : null));
  };
  const series = curves.flatMap((curve) => ['median', 'percentile_25', 'percentile_75'].map((key) => onto(curve, key)));
  return [xs, ...series];
}

function optionsOf(set, width) {
  const values = set.curves.flatMap((curve) => [...curve.percentile_25, ...curve.percentile_75]).filter((value) => value > 0);
  const logarithmic = values.length > 0 && Math.max(...values) > 30 * Math.min(...values);
  const one = (value) => (value == null ? '–' : digits(value));
  const series = [{ label: set.x_title, value: (u, value) => one(value) }], bands = [];
  set.curves.forEach((curve, i) => {
    const stroke = color(COLORS[i % COLORS.length]);
    const edge = { label: curve.label, stroke: 'transparent', points: { show: false }, spanGaps: true };
    series.push({ label: curve.label, stroke, width: 2, spanGaps: true, points: { show: true, size: 5 }, value: (u, value) => one(value) }, edge, { ...edge });
    bands.push({ series: [3 * i + 3, 3 * i + 2], fill: `color-mix(in srgb, ${stroke} 18%, transparent)` });
  });
  return {
    width, height: HEIGHT, series, bands, padding: [10, 14, 0, 0],
    cursor: { drag: { x: false, y: false } },
    scales: { x: { time: false, distr: set.x_logarithmic ? 3 : 1 },
      y: { distr: logarithmic ? 3 : 1, ...(logarithmic ? {} : { range: (u, low, high) => [Math.min(0, low ?? 0), 1.05 * (high ?? 1)] }) } },
    axes: [axis({ label: set.x_title, labelSize: 22 }), axis({ label: set.y_title, labelSize: 20, size: 56 })],
    hooks: { setSeries: [(u, index, { show }) => {
      // A curve goes with its band.
      if (index == null || show == null || index % 3 !== 1) return;
      for (const edge of [index + 1, index + 2]) if (u.series[edge].show !== show) u.setSeries(edge, { show });
    }] },
  };
}

export function curvePlots(set) {
  const holder = element('div', { class: 'plot curves' });
  let chart = null;
  const build = () => {
    chart?.destroy();
    chart = new uPlot(optionsOf(set, Math.max(280, holder.clientWidth)), aligned(set.curves), holder);
    // The bands' edges need no legend of their own.
    chart.root.querySelectorAll('.u-legend .u-series').forEach((row, i) => { if (i > 0 && i % 3 !== 1) row.remove(); });
  };
  requestAnimationFrame(build);
  whenColorsChange(build);
  new ResizeObserver(() => {
    if (chart && holder.clientWidth > 100 && Math.abs(holder.clientWidth - chart.width) > 2) chart.setSize({ width: holder.clientWidth, height: HEIGHT });
  }).observe(holder);
  return element('figure', { class: 'curve-set' }, element('figcaption', {}, element('h3', {}, set.title)), holder);
}
