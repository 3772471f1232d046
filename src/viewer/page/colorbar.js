// The colour bar beside the image, with ticks in physical units.
import {get_json, show_error} from './api.js';
import {linear_ticks, log_text, log_ticks, shared_exponent, superscript, tick_text, unit_text} from './format.js';
import {is_scalar, on, state} from './state.js';

const canvas = document.getElementById('colorbar');
const stage = document.getElementById('stage');
const kWidth = 14;
const kTop = 34;
const kBottom = 14;
const maps = new Map();  // name -> colours, or a promise of them

function colours_of(name) {
  if (!maps.has(name)) {
    const loaded = get_json('/api/colormap', {map: name})
                       .then(({colors}) => {
                         maps.set(name, colors);
                         draw();
                       })
                       .catch((error) => {
                         maps.delete(name);
                         show_error(error);
                       });
    maps.set(name, loaded);
  }
  const held = maps.get(name);
  return Array.isArray(held) ? held : null;
}

function ticks_of({low, high, unit}, logarithmic, count) {
  if (logarithmic && low > 0) return {ticks: log_ticks(low, high).map((v) => [v, log_text(v)]), title: unit_text(unit)};
  const percent = unit === '1';
  const exponent = percent ? -2 : shared_exponent(Math.max(Math.abs(low), Math.abs(high)));
  const values = linear_ticks(low, high, count);
  const step = values.length > 1 ? values[1] - values[0] : 1;
  const factor = percent || !exponent ? '' : `10${superscript(exponent)} `;
  return {
    ticks: values.map((v) => [v, tick_text(v, step, 10 ** exponent)]),
    title: percent ? '%' : factor + unit_text(unit)
  };
}

function draw() {
  const frame = state.frame;
  if (!frame || !is_scalar(frame.mode) || frame.low === null || frame.low === undefined) return;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const ratio = devicePixelRatio;
  Object.assign(canvas, {width: Math.round(width * ratio), height: Math.round(height * ratio)});
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  const colours = colours_of(frame.parameters.map);
  const length = height - kTop - kBottom;
  if (colours) {
    colours.forEach((colour, i) => {
      context.fillStyle = colour;
      const top = kTop + length * (1 - (i + 1) / colours.length);
      context.fillRect(0, Math.floor(top), kWidth, Math.ceil(length / colours.length) + 1);
    });
  }
  const logarithmic = frame.parameters.scale === 'log' && frame.low > 0;
  const place = logarithmic ? (v) => Math.log(v / frame.low) / Math.log(frame.high / frame.low) :
                              (v) => (v - frame.low) / (frame.high - frame.low);
  const {ticks, title} = ticks_of(frame, logarithmic, length / 60);
  const ink = getComputedStyle(stage).color;
  context.fillStyle = context.strokeStyle = ink;
  const size = parseFloat(getComputedStyle(canvas).fontSize) * 0.92;
  context.font = `${size}px system-ui, sans-serif`;
  context.textBaseline = 'middle';
  for (const [value, text] of ticks) {
    const y = Math.round(kTop + length * (1 - place(value))) + 0.5;
    context.beginPath();
    context.moveTo(kWidth, y);
    context.lineTo(kWidth + 4, y);
    context.stroke();
    context.fillText(text, kWidth + 8, y);
  }
  draw_title(context, title, width);
  canvas.setAttribute('aria-label', `Colour bar: ${frame.label}, ${title}`);
}

/** The unit above the bar, on two lines if it is long. */
function draw_title(context, title, width) {
  const words = title.split(' ');
  const lines = [''];
  for (const word of words) {
    const longer = `${lines[lines.length - 1]} ${word}`.trim();
    if (context.measureText(longer).width > width - 2 && lines[lines.length - 1])
      lines.push(word);
    else
      lines[lines.length - 1] = longer;
  }
  lines.slice(0, 2).forEach(
      (line, i) =>
          context.fillText(line, 0, kTop - 8 - 1.2 * parseFloat(context.font) * (Math.min(lines.length, 2) - 1 - i)));
}

function show() {
  const hidden = !is_scalar(state.view.mode);
  if (canvas.hidden !== hidden) {
    canvas.hidden = hidden;
    stage.classList.toggle('with-bar', !hidden);
  }
  draw();
}

on('frame view', show);
new ResizeObserver(draw).observe(canvas);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);
