// The scene's spectra: drawn, and replaced by others. A change restarts the rendering at once.
import {post} from './api.js';
import {button, element, number_field, row, select} from './dom.js';
import {linear_ticks, number, tick_text, unit_text} from './format.js';
import {set, state} from './state.js';

const kEdits = {
  constant: 'A constant',
  file: 'A file …',
  metal: 'A metal',
  glass: 'A glass',
  temperature: 'A temperature',
  scale: 'Times a factor',
};
let opened = null;        // id of the spectrum that is shown large
const edits = new Map();  // id -> kind of edit chosen

/** Runs of values between gaps as an SVG path. */
function path_of(wavelengths, values, x, y) {
  let path = '';
  let pen = 'M';
  wavelengths.forEach((wavelength, i) => {
    if (values[i] === null || values[i] === undefined) return (pen = 'M');
    path += `${pen}${x(wavelength).toFixed(2)} ${y(values[i]).toFixed(2)}`;
    pen = 'L';
  });
  return path;
}

function svg(tag, attributes, text) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

function extent(spectrum) {
  const all = [...spectrum.values, ...(spectrum.values_k ?? [])].filter((value) => value !== null);
  let [low, high] = [Math.min(0, ...all), Math.max(...all)];
  if (spectrum.unit === '1' && high <= 1 && high > 0.3) high = 1;
  if (!(high > low)) high = low + 1;
  return [low, high];
}

function spark(spectrum) {
  const [w, h] = [92, 26];
  const made = svg('svg', {class: 'spark', viewBox: `0 0 ${w} ${h}`, 'aria-hidden': 'true'});
  if (!(spectrum.values?.length > 1)) return made;
  const [low, high] = extent(spectrum);
  const wavelengths = spectrum.wavelength_nm;
  const span = wavelengths[wavelengths.length - 1] - wavelengths[0] || 1;
  const x = (v) => 1 + ((v - wavelengths[0]) / span) * (w - 2);
  const y = (v) => h - 2 - ((v - low) / (high - low)) * (h - 4);
  made.append(svg('line', {x1: 0, x2: w, y1: h - 0.5, y2: h - 0.5, class: 'axis'}));
  if (spectrum.values_k)
    made.append(svg('path', {d: path_of(wavelengths, spectrum.values_k, x, y), class: 'line second'}));
  made.append(svg('path', {d: path_of(wavelengths, spectrum.values, x, y), class: 'line'}));
  return made;
}

/** The spectrum with axes. */
function drawing(spectrum, width) {
  const [left, right, top, bottom] = [44, 16, 28, 34];
  const height = 160;
  const made = svg('svg', {
    class: 'drawing',
    viewBox: `0 0 ${width} ${height}`,
    width,
    height,
    role: 'img',
    'aria-label': `${spectrum.role} against wavelength`
  });
  const [low, high] = extent(spectrum);
  const wavelengths = spectrum.wavelength_nm;
  const micrometres = state.plot.micrometres;
  const scale = micrometres ? 1000 : 1;
  const [first, last] = [wavelengths[0] / scale, wavelengths[wavelengths.length - 1] / scale];
  const x = (v) => left + ((v / scale - first) / (last - first || 1)) * (width - left - right);
  const y = (v) => height - bottom - ((v - low) / (high - low)) * (height - top - bottom);
  const ticks = (list, text, place) => list.forEach((v) => place(v, text(v, list.length > 1 ? list[1] - list[0] : 1)));
  ticks(linear_ticks(low, high, 4), high >= 1e5 || high < 1e-2 ? (v) => number(v, 2) : tick_text, (v, text) => {
    made.append(svg('line', {x1: left, x2: width - right, y1: y(v), y2: y(v), class: 'grid'}));
    made.append(svg('text', {x: left - 6, y: y(v) + 4, 'text-anchor': 'end'}, text));
  });
  ticks(linear_ticks(first, last, (width - left) / 70), tick_text, (v, text) => {
    made.append(svg('text', {x: x(v * scale), y: height - bottom + 15, 'text-anchor': 'middle'}, text));
  });
  const unit = unit_text(spectrum.unit);
  const pair = spectrum.values_k ? 'n (line), k (dashed)' : spectrum.role;
  made.append(svg('text', {x: 0, y: 11, class: 'title'}, unit ? `${pair} (${unit})` : pair));
  made.append(
      svg('text', {x: width - right, y: height - 4, 'text-anchor': 'end', class: 'title'},
          `Wavelength (${micrometres ? 'µm' : 'nm'})`));
  if (spectrum.values_k)
    made.append(svg('path', {d: path_of(wavelengths, spectrum.values_k, x, y), class: 'line second'}));
  made.append(svg('path', {d: path_of(wavelengths, spectrum.values, x, y), class: 'line'}));
  return made;
}

const is_edited = (spectrum) => spectrum.edited ?? state.edited?.[spectrum.id];

async function apply(spectrum, change) {
  if (await post('/api/spectrum', {id: spectrum.id, set: change}))
    set({edited: {...state.edited, [spectrum.id]: !change.reset}});
}

/** What an edit asks for: a number, a name from a list, a file. */
function edit_control(spectrum, kind) {
  const materials = state.scene.choices?.materials ?? {};
  const typed = (key, value, unit) => {
    const field = number_field(
        value, (given) => given !== null && apply(spectrum, {[key]: given}),
        {'aria-label': `${kEdits[kind]} for ${spectrum.owner}`});
    return [field, element('span', {class: 'quiet'}, unit)];
  };
  if (kind === 'constant') return typed('constant', '', unit_text(spectrum.unit));
  if (kind === 'temperature') return typed('temperature_k', spectrum.value ?? '', 'K');
  if (kind === 'scale') return typed('scale', spectrum.value ?? 1, '×');
  if (kind === 'file') {
    const file = element('input', {type: 'file', 'aria-label': `File for ${spectrum.owner}`});
    file.onchange = async () => file.files[0] && apply(spectrum, {file_text: await file.files[0].text()});
    return [file];
  }
  const names = (kind === 'metal' ? materials.metals : materials.glasses) ?? [];
  const now = spectrum.name && names.includes(spectrum.name) ? [] : [['', '–']];
  const list = select(
      [...now, ...names.map((name) => [name, name])], spectrum.name ?? '',
      (name) => name && apply(spectrum, {[kind]: name}));
  list.setAttribute('aria-label', `${kEdits[kind]} for ${spectrum.owner}`);
  return [list];
}

function editor(spectrum, width, rebuild) {
  const made = element('div', {class: 'editor'});
  if (spectrum.values?.length > 1) made.append(drawing(spectrum, width));
  const kinds = spectrum.editable ?? [];
  if (kinds.length === 0) return made;
  const kind = kinds.includes(edits.get(spectrum.id)) ? edits.get(spectrum.id) :
      kinds.includes(spectrum.kind)                   ? spectrum.kind :
                                                        kinds[0];
  const which = select(kinds.map((k) => [k, kEdits[k] ?? k]), kind, (chosen) => {
    edits.set(spectrum.id, chosen);
    rebuild();
  });
  made.append(row('Replace by', which, ...edit_control(spectrum, kind)));
  if (is_edited(spectrum)) {
    made.append(
        element('div', {class: 'row alone'}, button('As in the scene file', () => apply(spectrum, {reset: true}))));
  }
  return made;
}

const value_text = (spectrum) => {
  if (spectrum.kind === 'temperature' && spectrum.value !== null) return `${number(spectrum.value, 4)} K`;
  return spectrum.name ?? '';
};

function entry(spectrum, width, rebuild) {
  const open = spectrum.id === opened;
  const head = element(
      'button',
      {
        class: 'entry',
        'aria-expanded': String(open),
        onclick: () => {
          opened = open ? null : spectrum.id;
          rebuild(spectrum.id);
        },
        'data-spectrum': spectrum.id,
      },
      element(
          'span', {class: 'name', title: `${spectrum.owner}, ${spectrum.role}`}, element('span', {}, spectrum.owner),
          element('span', {class: 'quiet'}, spectrum.role)),
      element('span', {class: 'now'}, is_edited(spectrum) ? '• ' : '', value_text(spectrum)),
      spectrum.kind === 'temperature' ? element('span', {class: 'spark'}) : spark(spectrum),
  );
  return element('li', {class: open ? 'open' : ''}, head, open ? editor(spectrum, width, rebuild) : null);
}

export function materials_tab(tab) {
  const list = element('ul', {class: 'spectra'});
  const fill = (focus) => {
    const width = Math.max(240, tab.clientWidth - 34);
    list.replaceChildren(...state.scene.spectra.map((spectrum) => entry(spectrum, width, fill)));
    if (!focus) return;
    list.querySelector(`[data-spectrum="${CSS.escape(focus)}"]`)?.focus();
    list.querySelector('li.open')?.scrollIntoView({block: 'nearest'});
  };
  tab.append(list);
  fill();
  // Scenes come with every movement of the camera: their spectra are compared, not drawn anew.
  let scene = state.scene;
  let spectra = JSON.stringify(scene.spectra);
  let rest = JSON.stringify([state.plot.micrometres, state.edited]);
  return () => {
    const rest_now = JSON.stringify([state.plot.micrometres, state.edited]);
    const spectra_now = scene === state.scene ? spectra : JSON.stringify(state.scene.spectra);
    scene = state.scene;
    if (spectra_now === spectra && rest_now === rest) return;
    spectra = spectra_now;
    rest = rest_now;
    fill(document.activeElement?.closest?.('[data-spectrum]')?.dataset.spectrum);
  };
}
