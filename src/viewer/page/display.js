// What the image shows: mode, exposure and tone, channel, colour map, range. The rendering is never asked to restart by
// any of it.
import {load_scene, post} from './api.js';
import {button, choice, element, number_field, row, select} from './dom.js';
import {tick_text, unit_text} from './format.js';
import {notice} from './notices.js';
import {channel_text} from './plot.js';
import {channel_count, default_ranges, has_channel, is_scalar, set_view, state} from './state.js';

const kModeTexts = {
  color: 'Colour',
  false: 'False colour',
  channel: 'Channel',
  error: 'Error',
  temperature: 'Temperature'
};
const kMaps = [['viridis', 'Viridis'], ['cividis', 'Cividis'], ['magma', 'Magma'], ['grey', 'Grey']];
const kStops = 10;  // either way

export const mode_text = (mode) => kModeTexts[mode] ?? mode.replace(/^response:/, '');

export function set_mode(mode) {
  const {low, high, bounds} = state.view;
  // Every mode keeps a range of its own: a temperature is none for a radiance.
  const kept = {...bounds, [state.view.mode]: {low, high}};
  set_view({mode, bounds: kept, ...(kept[mode] ?? {low: '', high: ''})});
}

export const set_exposure = (stops) => set_view({exposure: Math.max(-kStops, Math.min(kStops, stops))});
export const set_channel = (channel) => set_view({channel: Math.max(0, Math.min(channel_count() - 1, channel))});

function exposure_rows() {
  const slider = element(
      'input',
      {type: 'range', min: -kStops, max: kStops, step: 1 / 6, oninput: () => set_exposure(Number(slider.value))});
  const shown = element('output', {class: 'amount'});
  const auto = button('Auto', () => set_exposure(0), {title: 'White by itself: the 99th percentile at 0.9 (/)'});
  const tone = choice(
      'Tone curve', [['srgb', 'sRGB'], ['filmic', 'Filmic']], state.view.tone, (value) => set_view({tone: value}));
  const sync = () => {
    slider.value = state.view.exposure;
    slider.setAttribute('aria-valuetext', `${state.view.exposure.toFixed(1)} stops`);
    shown.textContent = `${state.view.exposure > 0 ? '+' : ''}${tick_text(state.view.exposure, 0.1)} EV`;
    auto.disabled = state.view.exposure === 0;
    tone.select(state.view.tone);
  };
  return {rows: [row('Exposure', slider, shown, auto), row('Tone', tone)], sync};
}

function range_rows() {
  const factor = () => (state.plot.micrometres ? 1000 : 1);
  const unit_name = () => (state.plot.micrometres ? 'µm' : 'nm');
  const names = {r: 'Red', g: 'Green', b: 'Blue'};
  const fields = [];
  const rows = Object.entries(names).map(([name, text]) => {
    const field = (index) => {
      const made =
          number_field('', (value) => change(name, index, value), {'aria-label': `${text}, ${index ? 'to' : 'from'}`});
      fields.push([made, name, index]);
      return made;
    };
    const first = field(0);
    return row(text, first, ' – ', field(1), element('span', {class: 'quiet'}, unit_name()));
  });
  function change(name, index, value) {
    const ranges = structuredClone(state.view.ranges ?? default_ranges());
    if (value === null)
      ranges[name][index] = default_ranges()[name][index];
    else
      ranges[name][index] = value * factor();
    ranges[name].sort((a, b) => a - b);
    set_view({ranges});
  }
  const sync = () => {
    const ranges = state.view.ranges ?? default_ranges();
    for (const [made, name, index] of fields) {
      if (made !== document.activeElement) made.value = Number((ranges[name][index] / factor()).toPrecision(6));
    }
  };
  return {rows, sync};
}

function channel_rows() {
  const slider = element(
      'input',
      {type: 'range', min: 0, max: channel_count() - 1, step: 1, oninput: () => set_channel(Number(slider.value))});
  const shown = element('output', {class: 'amount channel'});
  // As wide for every channel: the slider stays as it is under the mouse.
  shown.style.width = `${Math.max(...state.scene.channels.map((_, index) => channel_text(index).length))}ch`;
  const sync = () => {
    slider.value = state.view.channel;
    shown.textContent = shown.title = channel_text(state.view.channel);
    slider.setAttribute('aria-valuetext', shown.textContent);
  };
  return {rows: [row('Channel', slider, shown)], sync};
}

function map_rows() {
  const map = select(kMaps, state.view.map, (value) => set_view({map: value}));
  const scale =
      choice('Scale', [['linear', 'Linear'], ['log', 'Log']], state.view.scale, (value) => set_view({scale: value}));
  const bound = (name) => {
    const field = number_field('', (value) => {
      set_view({[name]: value === null ? '' : String(value / factor())});
      if (value === null || state.view[name] !== '') return;
      field.value = '';
      notice('The ends of a logarithmic scale are above 0.');
    }, {'aria-label': name === 'low' ? 'Lowest value' : 'Highest value'});
    return field;
  };
  const [low, high] = [bound('low'), bound('high')];
  const factor = () => (state.view.mode === 'error' ? 100 : 1);  // typed in per cent
  const unit = element('span', {class: 'quiet'});
  const auto = button('Auto', () => set_view({low: '', high: ''}), {title: 'From the 1st to the 99th percentile (/)'});
  const sync = () => {
    map.value = state.view.map;
    scale.select(state.view.scale);
    for (const [field, name] of [[low, 'low'], [high, 'high']]) {
      if (field !== document.activeElement)
        field.value = state.view[name] === '' ? '' : Number((Number(state.view[name]) * factor()).toPrecision(6));
      const used = state.frame?.mode === state.view.mode ? state.frame[name] : null;
      field.placeholder = used === null || used === undefined ? '' : plain_number(used * factor());
    }
    unit.textContent = state.view.mode === 'error' ? '%' : unit_text(state.frame?.unit);
    auto.disabled = state.view.low === '' && state.view.high === '';
  };
  const range = row('Range', low, ' – ', high, auto, unit);
  range.classList.add('wraps');  // a long unit stands below
  return {rows: [row('Colours', map, scale), range], sync};
}

/** As it could be typed. */
const plain_number = (value) => String(Number(value.toPrecision(3)));

function response_row() {
  const file = element('input', {type: 'file', accept: '.csv,.txt,text/plain', hidden: true});
  file.onchange = async () => {
    const [chosen] = file.files;
    if (!chosen) return;
    const name = chosen.name.replace(/\.[^.]*$/, '');
    if (await post(`/api/response?${new URLSearchParams({name})}`, await chosen.text())) {
      await load_scene();
      set_mode(`response:${name}`);
    }
    file.value = '';
  };
  const open = button(
      'Add a camera’s response …', () => file.click(),
      {title: 'A table of wavelength and sensitivities (CSV): its first three bands become red, green and blue'});
  return element('div', {class: 'row alone'}, open, file);
}

/** Fills the tab; returns what brings it up to date. */
export function display_tab(tab) {
  const view = state.view;
  const modes =
      state.scene.modes.map((mode, index) => [mode, mode_text(mode), `${index < 9 ? `Key ${index + 1}` : ''}`]);
  const mode = choice('What the image shows', modes, view.mode, set_mode);
  mode.classList.add('modes');
  const parts = [];
  if (!is_scalar(view.mode)) parts.push(exposure_rows());
  if (view.mode === 'false') parts.push(range_rows());
  if (has_channel(view.mode)) parts.push(channel_rows());
  if (is_scalar(view.mode)) parts.push(map_rows());
  const grid = element('input', {type: 'checkbox', onchange: () => set_view({grid: grid.checked})});
  tab.append(
      mode, ...parts.flatMap((part) => part.rows),
      row('Pixel grid', grid, element('span', {class: 'quiet'}, 'when zoomed in')));
  if (state.scene.modes.some((m) => m === 'color' || m.startsWith('response:'))) tab.append(response_row());
  return () => {
    mode.select(state.view.mode);
    grid.checked = state.view.grid;
    for (const part of parts) part.sync();
  };
}

/** The tab is built anew when this changes. */
export const display_shape = () =>
    JSON.stringify([state.scene.modes, state.view.mode, channel_count(), state.plot.micrometres]);
