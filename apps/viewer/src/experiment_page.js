// The page about an experiment: tables and curves.
import { element } from './dom.js';
import { curvePlots } from './curve_plots.js';

const NUMBER = (value, decimals) => (value == null ? '–' : value.toFixed(decimals));

function cell([value, low, high], column) {
  if (value == null) return element('td', { class: 'unknown' }, '–');
  const interval = low != null && high != null &&
    element('small', { title: '95 % confidence interval' }, ` ${NUMBER(low, column.decimals)} … ${NUMBER(high, column.decimals)}`);
  return element('td', {}, NUMBER(value, column.decimals), interval);
}

function tableOf(table) {
  return element('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': table.title }, element('table', { class: 'results' },
    element('thead', {}, element('tr', {}, element('th', { scope: 'col' }), element('th', { scope: 'col' }, 'runs'),
      table.columns.map((column) => element('th', { scope: 'col' }, column.title, column.unit && element('small', {}, ` ${column.unit}`))))),
    element('tbody', {}, table.rows.map((row) => element('tr', {}, element('th', { scope: 'row' }, row.label),
      element('td', {}, String(row.runs)), row.entries.map((entry, i) => cell(entry, table.columns[i])))))));
}

export function showExperiment(page, data) {
  page.append(...[
    element('header', {}, element('p', { class: 'brand' }, 'nearpose report'), element('h1', {}, data.title),
      data.command && element('p', {}, 'Made by ', element('code', {}, data.command))),
    data.tables.length > 1 && element('nav', { class: 'contents', 'aria-label': 'Tables' },
      data.tables.map((table) => element('a', { href: `#${encodeURIComponent(table.name)}` }, table.title))),
    ...data.tables.map((table) => element('section', { class: 'panel table-panel', id: encodeURIComponent(table.name) },
      element('h2', {}, table.title), table.text && element('p', {}, table.text),
      table.rows.length > 0 && tableOf(table), table.curve_sets.map((set) => curvePlots(set)))),
    element('p', { class: 'note' }, 'Small numbers are 95 % confidence intervals. Curves are medians, bands the middle half of the values. ' +
      'Contains uPlot and three.js (MIT licence, texts in the source of this file).')].filter(Boolean));
  if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
}
