// The image on its canvas: zoom, pan, pixel grid, pins. Coordinates: film pixels, (0, 0) the corner of the first;
// `scale` is CSS pixels per film pixel. 'fit' follows the size of the window until somebody zooms or pans.
import {on, set, state} from './state.js';
import {draw_values, values_fit} from './values.js';

const canvas = document.getElementById('image');
const kMinGridScale = 18;
const kMinOutlineScale = 8;  // from here on a pin is drawn around its pixel
const kMaxScale = 200;
const place = {
  scale: 1,
  x: 0,
  y: 0,
  fit: true
};
let bitmap = null;
let film = {width: 1, height: 1};
let asked = false;

export function show_bitmap(next, header) {
  bitmap?.close();
  bitmap = next;
  const changed = film.width !== header.full_width || film.height !== header.full_height;
  film = {width: header.full_width, height: header.full_height};
  if (changed) fit();
  redraw();
}

export function redraw() {
  if (asked) return;
  asked = true;
  requestAnimationFrame(() => {
    asked = false;
    draw();
  });
}

const size = () => ({width: canvas.clientWidth, height: canvas.clientHeight});

export function fit() {
  const {width, height} = size();
  place.fit = true;
  place.scale = Math.min(width / film.width, height / film.height) || 1;
  place.x = (width - film.width * place.scale) / 2;
  place.y = (height - film.height * place.scale) / 2;
  changed();
}

function changed() {
  set({zoom: place.scale * devicePixelRatio});
  redraw();
}

/** Zooms by `factor` about a point of the canvas, its middle if none is given. */
export function zoom(factor, x = size().width / 2, y = size().height / 2) {
  const scale = Math.min(kMaxScale, Math.max(Math.min(fit_scale(), 1) / 4, place.scale * factor));
  const ratio = scale / place.scale;
  Object.assign(place, {fit: false, scale, x: x - (x - place.x) * ratio, y: y - (y - place.y) * ratio});
  keep_in_sight();
  changed();
}

const fit_scale = () => Math.min(size().width / film.width, size().height / film.height);

/** One film pixel per pixel of the screen, or the whole image again. */
export function toggle_full_size() {
  const whole = 1 / devicePixelRatio;
  if (Math.abs(place.scale / whole - 1) < 1e-6)
    fit();
  else
    zoom(whole / place.scale);
}

export function pan(dx, dy) {
  place.fit = false;
  place.x += dx;
  place.y += dy;
  keep_in_sight();
  changed();
}

function keep_in_sight() {
  const {width, height} = size();
  const limit = (at, length, extent) => Math.min(extent - 40, Math.max(40 - length, at));
  place.x = limit(place.x, film.width * place.scale, width);
  place.y = limit(place.y, film.height * place.scale, height);
}

/** Brings a film pixel to where it can be seen. */
export function reveal([x, y]) {
  const {width, height} = size();
  const left = place.x + x * place.scale;
  const top = place.y + y * place.scale;
  const inset = Math.min(place.scale, 60);
  const dx = Math.max(0, inset - left) + Math.min(0, width - inset - place.scale - left);
  const dy = Math.max(0, inset - top) + Math.min(0, height - inset - place.scale - top);
  if (!place.fit && (dx || dy)) pan(dx, dy);
}

/** Film pixel under a point of the canvas; null outside. */
export function pixel_at(x, y) {
  const pixel = [Math.floor((x - place.x) / place.scale), Math.floor((y - place.y) / place.scale)];
  return bitmap && pixel[0] >= 0 && pixel[1] >= 0 && pixel[0] < film.width && pixel[1] < film.height ? pixel : null;
}

/** Like pixel_at(), the nearest one outside. */
export function nearest_pixel(x, y) {
  const clamp = (value, count) => Math.min(count - 1, Math.max(0, Math.floor(value)));
  return [clamp((x - place.x) / place.scale, film.width), clamp((y - place.y) / place.scale, film.height)];
}

/** The middle of a film pixel on the canvas. */
export const point_of = ([x, y]) => [place.x + (x + 0.5) * place.scale, place.y + (y + 0.5) * place.scale];

export const film_size = () => film;
export const image_scale = () => place.scale;

function draw() {
  const {width, height} = size();
  const ratio = devicePixelRatio;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, {width: w, height: h});
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  if (!bitmap) return;
  const full = bitmap.width === film.width;
  context.imageSmoothingEnabled = place.scale * ratio < 1 || !full;
  context.imageSmoothingQuality = 'high';
  context.drawImage(bitmap, place.x, place.y, film.width * place.scale, film.height * place.scale);
  if (state.view.grid && place.scale >= kMinGridScale) draw_grid(context, width, height);
  const sight = in_sight(width, height);
  if (full && values_fit(sight, place.scale)) draw_values(context, sight, place, luminance_of(sight));
  draw_pins(context);
}

/** Film pixels that can be seen, inclusive. */
function in_sight(width, height) {
  const [x0, y0] = nearest_pixel(0, 0);
  const [x1, y1] = nearest_pixel(width - 1, height - 1);
  return {x0, y0, x1, y1};
}

/** How bright the pixels in sight are shown, so that text on them can be read. */
function luminance_of({x0, y0, x1, y1}) {
  const [w, h] = [x1 - x0 + 1, y1 - y0 + 1];
  const small = new OffscreenCanvas(w, h).getContext('2d');
  small.drawImage(bitmap, x0, y0, w, h, 0, 0, w, h);
  const {data} = small.getImageData(0, 0, w, h);
  return (x, y) => {
    const at = 4 * ((y - y0) * w + (x - x0));
    return (0.2126 * data[at] + 0.7152 * data[at + 1] + 0.0722 * data[at + 2]) / 255;
  };
}

function draw_grid(context, width, height) {
  const {x0, y0, x1, y1} = in_sight(width, height);
  const at_x = (x) => Math.round(place.x + x * place.scale) + 0.5;
  const at_y = (y) => Math.round(place.y + y * place.scale) + 0.5;
  context.beginPath();
  for (let x = x0; x <= x1 + 1; ++x) {
    context.moveTo(at_x(x), at_y(y0));
    context.lineTo(at_x(x), at_y(y1 + 1));
  }
  for (let y = y0; y <= y1 + 1; ++y) {
    context.moveTo(at_x(x0), at_y(y));
    context.lineTo(at_x(x1 + 1), at_y(y));
  }
  context.lineWidth = 1;
  context.strokeStyle = 'rgba(128, 128, 128, 0.35)';
  context.stroke();
}

/** A rectangle of film pixels on the canvas. */
function box_of(select) {
  const [x0, y0, x1, y1] = select.length === 4 ? select : [...select, ...select];
  return [
    place.x + x0 * place.scale, place.y + y0 * place.scale, (x1 - x0 + 1) * place.scale, (y1 - y0 + 1) * place.scale
  ];
}

function outline(context, colour, width, trace) {
  for (const [style, line] of [['rgba(0, 0, 0, 0.75)', width + 2], [colour, width]]) {
    context.beginPath();
    trace();
    context.strokeStyle = style;
    context.lineWidth = line;
    context.stroke();
  }
}

function draw_pin(context, pin, strong) {
  const [x, y, w, h] = box_of(pin.select);
  const point = pin.select.length === 2 && place.scale < kMinOutlineScale;
  const width = strong ? 3 : 1.5;
  if (point)
    outline(context, pin.colour, width, () => context.arc(x + w / 2, y + h / 2, 5.5, 0, 2 * Math.PI));
  else
    outline(context, pin.colour, width, () => context.rect(x, y, w, h));
  if (!pin.letter) return;
  context.font = `600 ${getComputedStyle(canvas).fontSize} system-ui, sans-serif`;
  context.textBaseline = 'bottom';
  const [left, bottom] = point ? [x + w / 2 + 7, y + h / 2 - 4] : [x + w + 3, y + 2];
  context.lineWidth = 3.5;
  context.lineJoin = 'round';
  context.strokeStyle = 'rgba(0, 0, 0, 0.8)';
  context.strokeText(pin.letter, left, bottom);
  context.fillStyle = pin.colour;
  context.fillText(pin.letter, left, bottom);
}

function draw_pins(context) {
  for (const pin of state.pins) draw_pin(context, pin, pin.key === state.marked);
  if (state.selecting) draw_pin(context, {select: state.selecting, colour: '#ffffff'}, false);
  if (state.hover && (place.scale >= kMinOutlineScale || state.hover_by_keys)) {
    draw_pin(context, {select: state.hover, colour: '#ffffff'}, false);
  }
}

// In the next frame: the zoom is text below the image, which may change the image's size again.
new ResizeObserver(() => requestAnimationFrame(() => (place.fit ? fit() : changed()))).observe(canvas);
on('pins hover marked selecting view values', redraw);
