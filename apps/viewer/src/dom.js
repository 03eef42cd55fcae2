// Elements without a framework.

function furnish(made, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === 'function') made.addEventListener(key, value);
    else if (key === 'style') made.style.cssText = value; // the page's policy forbids the attribute
    else if (value === true) made.setAttribute(key, '');
    else if (value !== false && value != null) made.setAttribute(key, value);
  }
  made.append(...children.flat().filter((child) => child != null && child !== false));
  return made;
}

// Attributes that are functions are event listeners; children are texts, elements, or nothing.
export function element(name, attributes = {}, ...children) {
  return furnish(document.createElement(name), attributes, children);
}

export function drawing(name, attributes = {}, ...children) {
  return furnish(document.createElementNS('http://www.w3.org/2000/svg', name), attributes, children);
}

// The page's colours change with the system's light or dark setting.
export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export function whenColorsChange(act) {
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', act);
}

let groups = 0;

// Buttons of which one is chosen. `choices`: [[value, label], ...].
export function choice(label, choices, chosen, act) {
  const name = `choice-${groups++}`;
  return element('fieldset', { class: 'choice' }, element('legend', {}, label),
    choices.map(([value, text]) => element('label', {},
      element('input', { type: 'radio', name, value, checked: value === chosen, change: () => act(value) }),
      element('span', {}, text))));
}

export function toggle(label, on, act, swatch) {
  return element('label', { class: 'toggle' },
    element('input', { type: 'checkbox', checked: on, change: (event) => act(event.target.checked) }),
    swatch && element('i', { class: 'swatch', style: `background: var(--${swatch})`, 'aria-hidden': 'true' }),
    label);
}

// A number with few digits that still says something: 0.042, 1.37, 12.4, 412.
export function digits(value) {
  if (value == null || !Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  const decimals = size >= 100 ? 0 : size >= 10 ? 1 : size >= 0.1 || size === 0 ? 2 : 3;
  return value.toFixed(decimals);
}

// Neighbouring places that are set, as [begin, end).
export function stretches(flags) {
  const list = [];
  flags.forEach((set, i) => {
    if (!set) return;
    if (list.at(-1)?.[1] === i) list.at(-1)[1] = i + 1;
    else list.push([i, i + 1]);
  });
  return list;
}
