// The legend of the plot: a row per curve with its value at the marker, and the buttons of the plot.
import {get, show_error} from './api.js';
import {download, element} from './dom.js';
import {shared_exponent, superscript, unit_text, with_error} from './format.js';
import {place_text, selections, unpin, unpin_all} from './pins.js';
import {can_log_x, channel_text, curves_shown, readout_channel, reset_zoom} from './plot.js';
import {export_png} from './plot_picture.js';
import {on, set, set_plot, state} from './state.js';

const id = (name) => document.getElementById(name);
const body = id('legend').tBodies[0];

function swatch({letter, colour, dash}) {
  const made = element('span', {class: `swatch dash${dash % 3}`, 'aria-hidden': 'true'});
  made.style.borderTopColor = colour ?? 'currentColor';
  return element('td', {class: 'who'}, made, letter ? element('b', {}, letter) : '');
}

function unpin_button({key, letter}) {
  const attributes = {class: 'plain', 'aria-label': `Unpin ${letter}`, title: 'Unpin', onclick: () => unpin(key)};
  return element('button', attributes, '×');
}

function new_row(selection) {
  const last = element('td', {class: 'act'});
  const made =
      element('tr', {}, swatch(selection), element('td', {class: 'place'}), element('td', {class: 'value'}), last);
  if (selection.letter) {
    last.append(unpin_button(selection));
    made.addEventListener('mouseenter', () => set({marked: selection.key}));
    made.addEventListener('mouseleave', () => set({marked: null}));
  }
  return made;
}

/** Rows stay while their pins do: a button that is made anew while it is pressed would miss the click. */
const held = new Map();
function row_of(selection) {
  const name = selection.letter + selection.key;
  if (!held.has(name)) held.set(name, new_row(selection));
  return held.get(name);
}

function fill_row(row, {selection, curve}, channel, scale) {
  const pixels = selection.select?.length === 4 && curve ? ` (${curve.pixels} px)` : '';
  const scaled = (value) => (value === null || value === undefined ? value : value / scale);
  const known = channel !== null && curve;
  row.cells[1].textContent = selection.select ? place_text(selection) + pixels : '–';
  row.cells[2].textContent =
      known ? with_error(scaled(curve.mean[channel]), scaled(curve.standard_error?.[channel])) : '';
}

/** The row of the pixel under the mouse is always there, so that nothing jumps when the mouse comes and goes. */
function rows_shown() {
  const curve_of = new Map(curves_shown().map(({selection, curve}) => [selection.key, curve]));
  const hover = selections().find((selection) => !selection.letter);
  const first = {key: '', letter: '', colour: null, dash: 0, select: hover?.select ?? null};
  return [[first, hover?.key], ...state.pins.map((pin) => [pin, pin.key])].map(
      ([selection, key]) => ({selection, curve: curve_of.get(key)}));
}

function put_rows(rows) {
  const wanted = rows.map(({selection}) => row_of(selection));
  if (wanted.length === body.rows.length && wanted.every((row, i) => row === body.rows[i])) return;
  body.replaceChildren(...wanted);
  for (const [name, row] of held) {
    if (!row.isConnected) held.delete(name);
  }
}

function show() {
  if (!state.scene) return;
  const channel = readout_channel();
  const rows = rows_shown();
  const largest = Math.max(0, ...rows.map(({curve}) => Math.abs(curve?.mean[channel] ?? 0)));
  const exponent = shared_exponent(largest);
  const unit = [
    exponent ? `10${superscript(exponent)}` : '', unit_text(state.scene.channels[channel]?.unit)
  ].filter(Boolean).join(' ');
  id('legend-channel').textContent = id('legend-channel').title =
      channel === null ? '' : [`at ${channel_text(channel)}`, unit].filter(Boolean).join(', ');
  put_rows(rows);
  rows.forEach((shown, i) => fill_row(body.rows[i], shown, channel, 10 ** exponent));
  id('legend-actions').hidden = state.pins.length === 0;
  const curves = curves_shown().map((shown) => shown.curve);
  const has_bands = curves.some((curve) => curve.standard_error);
  const without = has_bands && curves.some((curve) => curve.pixels > 1 && !curve.standard_error);
  id('plot-band').textContent = has_bands ? `Bands: ± 1 standard error${without ? ' (of pixels)' : ''}` : '';
  id('plot-band').title =
      without ? 'The errors of a rectangle’s pixels are not independent, so that of their mean is not known' : '';
}

async function export_csv() {
  try {
    const select = state.pins.map((pin) => pin.key).join(';');
    const response = await get('/api/export.csv', {select});
    download(await response.blob(), `${state.scene.name.replace(/\.[^.]*$/, '')}_spectra.csv`);
  } catch (error) {
    show_error(error);
  }
}

export function toggle_unit() {
  set_plot({micrometres: !state.plot.micrometres});
}

id('plot-log-y').onclick = () => set_plot({log_y: !state.plot.log_y});
id('plot-log-x').onclick = () => set_plot({log_x: !state.plot.log_x});
id('plot-unit').onclick = toggle_unit;
id('plot-reset').onclick = reset_zoom;
id('unpin').onclick = unpin_all;
id('export-csv').onclick = export_csv;
id('export-png').onclick = export_png;

on('plot scene', () => {
  id('plot-log-y').setAttribute('aria-pressed', state.plot.log_y);
  id('plot-log-x').setAttribute('aria-pressed', state.plot.log_x && can_log_x());
  id('plot-log-x').disabled = !can_log_x();
  id('plot-unit').textContent = state.plot.micrometres ? 'µm' : 'nm';
});
on('plot_zoomed', () => (id('plot-reset').hidden = !state.plot_zoomed));
on('drawn pointed view', show);
