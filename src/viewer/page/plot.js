// The plot of spectra: curves with bands of one standard error, the marker of the channel that the image shows. Drawn
// by dygraphs.
import {linear_ticks, log_text, log_ticks, shared_exponent, superscript, tick_text, unit_text, wavelength} from './format.js';
import {selections} from './pins.js';
import {channel_centre, channel_count, channels_in_order, default_ranges, has_channel, on, set, set_view, state} from './state.js';

const box = document.getElementById('plot');
const note = document.getElementById('plot-note');
let graph = null;
const kUnseen = {
  key: '',
  colour: '#0000',
  dash: 0
};
const kInvitation = 'Point at the image for a spectrum; click to pin it.';
let drawn = [];    // [{selection, curve}] in the order of the series
let plotted = [];  // what the graph has: the same, or one that is not seen
let order = [];    // channels by rows of the graph
let asked = false;

export const in_axis_unit = (nm) => (state.plot.micrometres ? nm / 1000 : nm);
/** Bands without wavelengths stand at 0, where a logarithmic axis has no place. */
const has_place = (index) => channel_centre(index) > 0;
export const can_log_x = () => Boolean(state.scene?.channels.some((_, index) => has_place(index)));
const is_log_x = () => state.plot.log_x && can_log_x();
export const curves_shown = () => drawn;
export const the_graph = () => graph;
const text_size = () => 0.92 * parseFloat(getComputedStyle(document.documentElement).fontSize);
const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** The smallest number that a logarithmic axis shows: bands that reach zero end there. */
function log_floor(curves) {
  let least = Infinity;
  let most = 0;
  for (const {curve} of curves) {
    for (const value of curve.mean) {
      if (value > 0) [least, most] = [Math.min(least, value), Math.max(most, value)];
    }
  }
  return Number.isFinite(least) ? Math.max(least / 2, most * 1e-8) : 1e-12;
}

function bars(curve, index, floor) {
  const mean = curve.mean[index];
  const nothing = [NaN, NaN, NaN];  // the line ends; at null it would go on
  if (mean === null) return nothing;
  const error = curve.standard_error?.[index] ?? 0;
  if (!state.plot.log_y) return [mean - error, mean, mean + error];
  return mean > 0 ? [Math.max(floor, mean - error), Math.max(floor, mean), Math.max(floor, mean + error)] : nothing;
}

const is_response = (index) => state.scene.channels[index].derived;
const has_responses = () => state.scene.channels.some(({derived}) => derived);

/** A column per curve for its channels; if there are responses, another one for those. */
function table() {
  const floor = state.plot.log_y ? log_floor(plotted) : 0;
  order = channels_in_order().filter((index) => !is_log_x() || has_place(index));
  const columns = (index, responses) =>
      plotted.map(({curve}) => (is_response(index) === responses ? bars(curve, index, floor) : null));
  return order.map(
      (index) =>
          [in_axis_unit(channel_centre(index)),
           ...columns(index, false),
           ...(has_responses() ? columns(index, true) : []),
  ]);
}

/** The band of one standard error where that is known; of a response, which no line goes through, a stroke. */
function draw_errors({drawingContext: context, seriesIndex, points, plotArea, color}) {
  const errors = plotted[seriesIndex % plotted.length].curve.standard_error;
  if (!errors) return;
  const at = (part) => plotArea.y + plotArea.h * part;
  const strokes = seriesIndex >= plotted.length;
  let last = null;
  context.save();
  context.globalAlpha = strokes ? 0.6 : 0.22;
  context.fillStyle = context.strokeStyle = color;
  context.beginPath();
  for (const point of points.filter(({yval}) => yval !== null)) {
    const known = Number.isFinite(point.y) && typeof errors[order[point.idx]] === 'number';
    const [high, low] = [at(point.y_top), at(point.y_bottom)];
    if (known && strokes) {
      context.moveTo(point.canvasx, high);
      context.lineTo(point.canvasx, low);
    } else if (known && last) {
      context.moveTo(last.x, last.high);
      context.lineTo(point.canvasx, high);
      context.lineTo(point.canvasx, low);
      context.lineTo(last.x, last.low);
      context.closePath();
    }
    last = known ? {x: point.canvasx, high, low} : null;
  }
  if (strokes)
    context.stroke();
  else
    context.fill();
  context.restore();
}

function x_ticks(low, high, pixels) {
  const logarithmic = is_log_x() && low > 0;
  const ticks = logarithmic ? log_ticks(low, high) : linear_ticks(low, high, pixels / (5.5 * text_size()));
  const step = ticks.length > 1 ? ticks[1] - ticks[0] : 1;
  return ticks.map((v) => ({v, label: logarithmic ? log_text(v) : tick_text(v, step)}));
}

let exponent = 0;  // that the labels of the vertical axis share
function y_ticks(low, high, pixels) {
  if (box.classList.contains('empty')) return [];
  if (state.plot.log_y && low > 0) {
    set_exponent(0);
    return log_ticks(low, high).map((v) => ({v, label: log_text(v)}));
  }
  const ticks = linear_ticks(low, high, pixels / (3.6 * text_size()));
  const step = ticks.length > 1 ? ticks[1] - ticks[0] : 1;
  set_exponent(shared_exponent(Math.max(Math.abs(low), Math.abs(high))));
  return ticks.map((v) => ({v, label: tick_text(v, step, 10 ** exponent)}));
}

function set_exponent(value) {
  exponent = value;
  document.getElementById('plot-y').textContent = y_title();
}

export function y_title() {
  const channels = state.scene?.channels ?? [];
  const spectral = channels.find(({derived}) => !derived);
  const name = spectral ? 'Spectral radiance' : 'Response';
  const factor = exponent ? `10${superscript(exponent)} ` : '';
  const measure = `${factor}${unit_text(spectral?.unit)}`.trim();
  const points = spectral && has_responses() ? '; points: responses' : '';
  return (measure ? `${name} (${measure})` : name) + points;
}
export const x_title = () => `Wavelength (${state.plot.micrometres ? 'µm' : 'nm'})`;

/** What the image shows, behind the curves: the channel, or three ranges of false colour. */
function draw_marker(context, area, g) {
  if (!state.scene) return;
  const stripe = (low, high, colour) => {
    const left = g.toDomXCoord(in_axis_unit(low));
    const width = Math.max(1.5, g.toDomXCoord(in_axis_unit(high)) - left);
    context.fillStyle = colour;
    context.fillRect(Math.max(area.x, left), area.y, Math.min(width, area.x + area.w - left), area.h);
  };
  const {mode, channel, ranges} = state.view;
  if (has_channel(mode) && state.scene.channels[channel]) {
    const {min_nm, max_nm} = state.scene.channels[channel];
    stripe(min_nm, max_nm, style('--marker'));
  } else if (mode === 'false') {
    const {r, g: green, b} = ranges ?? default_ranges();
    stripe(...b, 'rgba(60, 110, 255, 0.2)');
    stripe(...green, 'rgba(40, 170, 70, 0.2)');
    stripe(...r, 'rgba(240, 60, 50, 0.2)');
  }
}

/** The channel nearest to a place on the horizontal axis. */
function channel_near(x) {
  let best = 0;
  state.scene.channels.forEach((_, index) => {
    const distance = (i) => Math.abs(in_axis_unit(channel_centre(i)) - x);
    if (distance(index) < distance(best)) best = index;
  });
  return best;
}

/** A click shows a channel; the first of a double click, which ends a zoom, does not. */
const kDoubleClick_ms = 220;
let click_timer = 0;
function click(event) {
  const channel = channel_near(graph.toDataXCoord(graph.eventToDomCoords(event)[0]));
  clearTimeout(click_timer);
  if (event.detail > 1) return;
  click_timer = setTimeout(
      () => set_view(has_channel(state.view.mode) ? {channel} : {channel, mode: 'channel'}), kDoubleClick_ms);
}

const kDashes = [null, [7, 3], [2, 3]];

function options() {
  const series = {};
  plotted.forEach(({selection}, i) => {
    const strong = selection.key === state.marked;
    series[`c${i}`] = {
      color: selection.colour ?? style('--text'),
      strokeWidth: strong  ? 3 :
          selection.colour ? 1.6 :
                             1.1,
      strokePattern: kDashes[selection.dash % kDashes.length],
    };
    series[`r${i}`] = {color: series[`c${i}`].color, strokeWidth: 0, drawPoints: true, pointSize: strong ? 5 : 3.5};
  });
  const few = state.scene.channels.length <= 40;
  const size_px = text_size();
  return {
    labels: ['x', ...plotted.map((_, i) => `c${i}`), ...(has_responses() ? plotted.map((_, i) => `r${i}`) : [])],
    series,
    drawPoints: few && !box.classList.contains('empty'),
    pointSize: 2.5,
    logscale: state.plot.log_y,
    gridLineColor: style('--grid'),
    axisLineColor: style('--line'),
    axes: {
      x: {logscale: is_log_x(), ticker: (a, b, pixels) => x_ticks(a, b, pixels), axisLineColor: style('--line')},
      y: {ticker: (a, b, pixels) => y_ticks(a, b, pixels), axisLabelWidth: 3.6 * size_px},
    },
    axisLabelFontSize: size_px,
  };
}

function make(file) {
  graph = new Dygraph(box, file, {
    ...options(),
    customBars: true,
    plotter: [draw_errors, Dygraph.Plotters.linePlotter],
    legend: 'never',
    showLabelsOnHighlight: false,
    highlightCircleSize: 3.5,
    connectSeparatedPoints: true,  // those of another column stand between
    rightGap: 10,
    xRangePad: 4,
    yRangePad: 8,
    underlayCallback: draw_marker,
    clickCallback: click,
    highlightCallback: (event, x, points, row) => set({pointed: order[row]}),
    unhighlightCallback: () => set({pointed: null}),
    zoomCallback: () => set({plot_zoomed: graph.isZoomed()}),
  });
}

function draw() {
  asked = false;
  if (!state.scene) return;
  const current = state.curves.filter((curve) => curve.mean.length === channel_count());
  const by_key = new Map(current.map((curve) => [curve.select, curve]));
  const shown = selections().filter((selection) => by_key.has(selection.key));
  drawn = shown.map((selection) => ({selection, curve: by_key.get(selection.key)}));
  const empty = !drawn.some(({curve}) => curve.mean.some((value) => (state.plot.log_y ? value > 0 : value !== null)));
  note.hidden = !empty;
  note.textContent = !drawn.length ? kInvitation :
      state.plot.log_y             ? 'There is nothing above zero here.' :
                                     'There are no samples here.';
  box.classList.toggle('empty', empty);
  // An empty plot keeps its horizontal axis: one series that is not seen.
  plotted = drawn;
  if (empty) plotted = [{selection: kUnseen, curve: {mean: state.scene.channels.map(() => 1)}}];
  const file = table();
  if (graph)
    graph.updateOptions({...options(), file});
  else
    make(file);
  document.getElementById('plot-y').textContent = y_title();
  document.getElementById('plot-x').textContent = x_title();
  set({drawn: true});
}

export function redraw_plot() {
  if (asked) return;
  asked = true;
  requestAnimationFrame(draw);
}

export function reset_zoom() {
  graph?.resetZoom();
  set({plot_zoomed: false});
}

new ResizeObserver(() => graph?.resize()).observe(box);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw_plot);
on('curves pins hover scene view plot marked', redraw_plot);
on('plot channels_changed', reset_zoom);

/** What the marker stands at, or what the mouse points at in the plot. */
export function readout_channel() {
  if (state.pointed !== null && state.pointed !== undefined) return state.pointed;
  return has_channel(state.view.mode) ? state.view.channel : null;
}
/** Its wavelength and its name, of which it may lack either. */
export function channel_text(index) {
  const {name} = state.scene.channels[index];
  const own_name = /^[\d.e+]+-[\d.e+]+ nm$/.test(name) ? '' : name;  // else the server's, from the bounds
  if (!has_place(index)) return own_name || `channel ${index}`;
  const place = wavelength(channel_centre(index), state.plot.micrometres);
  return own_name ? `${own_name} (${place})` : place;
}
