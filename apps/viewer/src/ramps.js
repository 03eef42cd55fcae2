// Colours for numbers.

// Near is warm and light, far is cold and dark.
const STOPS = ['#fff0c2', '#fcc15a', '#f0803c', '#cf4a5c', '#8f3f8c', '#4a4aa8', '#2a3a78']
  .map((hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255));

export function depthColor(fraction) {
  const place = Math.max(0, Math.min(1, fraction)) * (STOPS.length - 1);
  const below = Math.min(Math.floor(place), STOPS.length - 2);
  return STOPS[below].map((channel, i) => channel + (place - below) * (STOPS[below + 1][i] - channel));
}

// Blue (in front of the model) over pale to red (behind it), for -1..1.
export function residualColor(fraction) {
  const x = Math.max(-1, Math.min(1, fraction));
  const end = x < 0 ? [0.13, 0.4, 0.87] : [0.86, 0.16, 0.16];
  const middle = [0.8, 0.82, 0.78];
  const t = Math.abs(x) ** 0.7;
  return middle.map((channel, i) => channel + t * (end[i] - channel));
}

export function gradient(colorOf, from = 0, to = 1) {
  const stops = [];
  for (let i = 0; i <= 12; ++i) {
    const rgb = colorOf(from + (to - from) * i / 12).map((channel) => Math.round(255 * channel));
    stops.push(`rgb(${rgb})`);
  }
  return `linear-gradient(to right, ${stops.join(', ')})`;
}
