// The legend of the plot: a row per curve with its value at the marker, and the buttons of the plot.
import {get, show_error} from './api.js';
import {download, element} from './dom.js';
import {shared_exponent, superscript, unit_text, with_error} from './format.js';
import {place_text, unpin, unpin_all} from './pins.js';
import {channel_text, curves_shown, readout_channel, reset_zoom} from './plot.js';
import {export_png} from './plot_picture.js';
import {on, set, set_plot, state} from './state.js';

const id = (name) => document.getElementById(name);
const body = id('legend').tBodies[0];

function swatch({letter, colour, dash}) {
  const made = element('span', {class: `swatch dash${dash % 3}`, 'aria-hidden': 'true'});
  made.style.borderTopColor = colour ?? 'currentColor';
  return element('td', {class: 'who'}, made, letter ? element('b', {}, letter) : '');
}

function legend_row({selection, curve}, channel, scale) {
  const pixels = selection.select?.length === 4 ? ` (${curve.pixels} px)` : '';
  const error = curve?.standard_error?.[channel];
  const scaled = (value) => (value === null || value === undefined ? value : value / scale);
  const value = channel === null || !curve ? '' : with_error(scaled(curve.mean[channel]), scaled(error));
  const made = element(
      'tr', {}, swatch(selection),
      element('td', {class: 'place'}, selection.select ? place_text(selection) + pixels : '–'),
      element('td', {class: 'value'}, value));
  const last = element('td', {class: 'act'});
  if (selection.letter) {
    const close = element(
        'button', {
          class: 'plain',
          'aria-label': `Unpin ${selection.letter}`,
          title: 'Unpin',
          onclick: () => unpin(selection.key)
        },
        '×');
    last.append(close);
    made.addEventListener('mouseenter', () => set({marked: selection.key}));
    made.addEventListener('mouseleave', () => set({marked: null}));
  }
  made.append(last);
  return made;
}

/** The row of the pixel under the mouse is always there, so that nothing jumps when the mouse comes and goes. */
function rows_shown() {
  const pins = curves_shown().filter(({selection}) => selection.letter);
  const hover = curves_shown().find(({selection}) => !selection.letter);
  return [hover ?? {selection: {key: '', select: null, letter: '', colour: null, dash: 0}, curve: null}, ...pins];
}

function show() {
  if (!state.scene) return;
  const channel = readout_channel();
  const rows = rows_shown();
  const largest = Math.max(0, ...rows.map(({curve}) => Math.abs(curve?.mean[channel] ?? 0)));
  const exponent = shared_exponent(largest);
  const unit = [exponent ? `10${superscript(exponent)}` : '', unit_text(state.scene.unit)].filter(Boolean).join(' ');
  id('legend-channel').textContent =
      channel === null ? '' : [`at ${channel_text(channel)}`, unit].filter(Boolean).join(', ');
  body.replaceChildren(...rows.map((shown) => legend_row(shown, channel, 10 ** exponent)));
  id('legend-actions').hidden = state.pins.length === 0;
  id('plot-band').textContent =
      curves_shown().some(({curve}) => curve.standard_error) ? 'Bands: ± 1 standard error' : '';
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

on('plot', () => {
  id('plot-log-y').setAttribute('aria-pressed', state.plot.log_y);
  id('plot-log-x').setAttribute('aria-pressed', state.plot.log_x);
  id('plot-unit').textContent = state.plot.micrometres ? 'µm' : 'nm';
});
on('plot_zoomed', () => (id('plot-reset').hidden = !state.plot_zoomed));
on('drawn pointed view', show);
