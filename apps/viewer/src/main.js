// Shows what `nearpose report` put into the page.
import 'uplot/dist/uPlot.min.css';
import './style.css';
import { showRun } from './run_page.js';
import { showExperiment } from './experiment_page.js';
import { element } from './dom.js';

const page = document.getElementById('page');
try {
  const data = JSON.parse(document.getElementById('data').textContent);
  (data.kind === 'experiment' ? showExperiment : showRun)(page, data);
} catch (error) {
  page.append(element('p', { class: 'failure', role: 'alert' }, `This report cannot be shown: ${error.message}`));
  console.error(error);
}
