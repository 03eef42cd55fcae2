// The depth image of a frame, coloured, with the model's lines and the mask's border over it.
import { depthColor, gradient } from './ramps.js';
import { color, digits, element, toggle } from './dom.js';

const CREASE = 1, OUTLINE = 2, MASK_BORDER = 4, BACKGROUND = 8;

async function greyOf(url) {
  const image = new Image();
  image.src = url;
  await image.decode();
  const canvas = new OffscreenCanvas(image.width, image.height);
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  const { data } = context.getImageData(0, 0, image.width, image.height);
  return { width: image.width, height: image.height, at: (pixel) => data[4 * pixel] };
}

const PALETTE = Array.from({ length: 256 }, (_, i) => depthColor((i - 1) / 254).map((c) => Math.round(255 * c)));

function mix(data, at, rgb, opacity) {
  for (let c = 0; c < 3; ++c) data[at + c] += opacity * (rgb[c] - data[at + c]);
}

// Depth to colours; what the mask leaves out is grey.
function paintDepth(data, depth, lines) {
  for (let y = 0; y < lines.height; ++y) {
    for (let x = 0; x < lines.width; ++x) {
      const pixel = y * lines.width + x;
      const grey = depth.at(Math.floor(y / 2) * depth.width + Math.floor(x / 2));
      let rgb = PALETTE[grey];
      if (grey === 0) rgb = (x + y) % 8 < 2 ? [44, 50, 62] : [26, 30, 39];
      else if (lines.at(pixel) & BACKGROUND) rgb = Array(3).fill(48 + 0.3 * (255 - grey));
      data.set([...rgb, 255], 4 * pixel);
    }
  }
}

function paintLines(data, lines, shown) {
  const paint = (bit, rgb, opacity, reach) => {
    for (let y = 0; y < lines.height; ++y) {
      for (let x = 0; x < lines.width; ++x) {
        if (!(lines.at(y * lines.width + x) & bit)) continue;
        for (let v = Math.max(0, y - reach); v <= Math.min(lines.height - 1, y + reach); ++v) {
          for (let u = Math.max(0, x - reach); u <= Math.min(lines.width - 1, x + reach); ++u) {
            mix(data, 4 * (v * lines.width + u), rgb, opacity);
          }
        }
      }
    }
  };
  if (shown.mask) paint(MASK_BORDER, [255, 255, 255], 0.85, 0);
  if (!shown.outline) return;
  paint(CREASE, [10, 22, 14], 0.55, 0);
  paint(OUTLINE, [8, 14, 10], 0.22, 1);
  paint(OUTLINE, [95, 255, 150], 0.95, 0);
}

export class DepthView {
  constructor(frames) {
    this.frames = frames;
    this.shown = { outline: true, mask: true };
    this.canvas = element('canvas', { class: 'depth', role: 'img', 'aria-label': 'Depth image of the frame' });
    this.near = element('span');
    this.far = element('span');
    const redraw = (name) => (on) => { this.shown[name] = on; this.show(this.index); };
    this.panel = element('figure', { class: 'panel depth-panel' },
      element('figcaption', {}, element('h2', {}, 'Depth image'),
        element('span', { class: 'toggles' }, toggle('Model outline', true, redraw('outline'), 'outline'),
          frames.some((frame) => frame.has_mask) && toggle('Mask border', true, redraw('mask'), 'mask'))),
      this.canvas,
      element('div', { class: 'scale' }, this.near,
        element('i', { style: `background: ${gradient(depthColor)}`, 'aria-hidden': 'true' }), this.far));
  }

  async show(index) {
    this.index = index;
    const frame = this.frames[index];
    if (frame.unread) return this.showUnread(frame);
    const [depth, lines] = await Promise.all([greyOf(frame.depth_png), greyOf(frame.lines_png)]);
    if (this.index !== index) return undefined; // a later frame was asked for meanwhile
    this.canvas.width = lines.width;
    this.canvas.height = lines.height;
    const context = this.canvas.getContext('2d');
    const image = context.createImageData(lines.width, lines.height);
    paintDepth(image.data, depth, lines);
    paintLines(image.data, lines, this.shown);
    context.putImageData(image, 0, 0);
    this.near.textContent = `${digits(1e3 * frame.near_m)} mm`;
    this.far.textContent = `${digits(1e3 * frame.far_m)} mm`;
    this.canvas.dataset.frame = index;
    return undefined;
  }

  showUnread(frame) {
    const context = this.canvas.getContext('2d');
    this.canvas.width = this.canvas.width || 640;
    context.fillStyle = color('muted');
    context.font = '16px sans-serif';
    context.fillText('This frame could not be read', 20, 40);
    this.canvas.title = frame.unread;
  }
}
