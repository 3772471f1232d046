// Tabs of the panel that act on the server: rendering, camera, saving.
import {get, post, show_error} from './api.js';
import {move_to, reset_camera, rest} from './camera.js';
import {button, choice, element, number_field, row, select} from './dom.js';
import {tick_text} from './format.js';
import {notice} from './notices.js';
import {frame_parameters, set, state} from './state.js';

export const is_paused = () => state.status?.state === 'paused';

export const toggle_pause = () => post('/api/control', {action: is_paused() ? 'resume' : 'pause'});
export const restart = () => post('/api/control', {action: 'restart'});

const change = (settings) => post('/api/settings', settings);

/** [first, last, count] of channels that follow on each other and are equally wide; null of others. */
function equal_channels() {
  const {channels} = state.scene;
  const first = channels[0].min_nm;
  const last = channels[channels.length - 1].max_nm;
  const at = (i) => first + ((last - first) * i) / channels.length;
  const near = (value, i) => Math.abs(value - at(i)) < 1e-4 * (at(1) - at(0));
  return channels.every(({min_nm, max_nm}, i) => near(min_nm, i) && near(max_nm, i + 1)) ?
      [first, last, channels.length] :
      null;
}

function band_list(settings) {
  const send = () => whole.value.trim() && change({bands: whole.value.trim()});
  const whole = element('input', {type: 'text', spellcheck: 'false', autocomplete: 'off', onchange: send});
  whole.value = settings.bands ?? '';
  whole.placeholder = `${state.scene.channels.length}, as in the scene file`;
  whole.title = 'First:last:count in nm, or a list such as 400-410, 450-500';
  return [row('Channels', whole)];
}

/** First, last and number of equal channels as three fields; others as the text that asks for them. */
function band_rows(settings) {
  const parts = equal_channels();
  if (!parts) return band_list(settings);
  const send = () => {
    const [low, high, count] = [from, to, number_of].map((field) => field.value.trim());
    if (low && high && count) change({bands: `${low}:${high}:${count}`});
  };
  const from = number_field(parts[0], send, {'aria-label': 'Shortest wavelength, nm'});
  const to = number_field(parts[1], send, {'aria-label': 'Longest wavelength, nm'});
  const number_of = number_field(parts[2], send);
  return [row('Range', from, ' – ', to, element('span', {class: 'quiet'}, 'nm')), row('Channels', number_of)];
}

function backend_rows(settings) {
  const backends = state.scene.choices?.backends ?? [];
  // Which device it is is known once the scene is compiled for it.
  const of_backend = (b) => b.name === settings.backend;
  const is_used = (b) => of_backend(b) && b.device === settings.device;
  const found = backends.findIndex(is_used);
  const at = Math.max(0, found < 0 ? backends.findIndex(of_backend) : found);
  const kinds = {cpu: 'CPU', opencl: 'OpenCL', 'cpu+opencl': 'CPU and OpenCL'};
  const list = backends.map((b, i) => [i, `${kinds[b.name] ?? b.name}: ${b.device}`]);
  const pick = (chosen) => {
    const {name, index, methods} = backends[Number(chosen)];
    const method = methods.includes(settings.method) ? settings.method : methods[0];
    change({backend: name, method, ...(index === null ? {} : {device: String(index)})});
  };
  const rows = [];
  if (list.length) rows.push(row('Device', select(list, at, pick)));
  const methods = backends[at]?.methods ?? [];
  if (methods.length > 1)
    rows.push(row('Method', select(methods.map((m) => [m, m]), settings.method, (method) => change({method}))));
  else if (methods.length)
    rows.push(
        element('div', {class: 'row'}, element('span', {class: 'label'}, 'Method'), element('span', {}, methods[0])));
  return rows;
}

export function render_tab(tab) {
  const settings = state.scene.settings;
  const pause = button('', toggle_pause, {title: 'Space', class: 'wide'});
  const again = button('Restart', restart, {title: 'Shift+R', class: 'wide'});
  tab.append(element('div', {class: 'row alone'}, pause, again), ...backend_rows(settings), ...band_rows(settings));
  if (settings.wavelengths) {
    const choices = [
      ['shared', 'Shared', 'One offset for all pixels of a block and sample: fast'],
      ['per-path', 'Per path', 'An offset for every path']
    ];
    tab.append(row(
        'Wavelengths', choice('Wavelengths', choices, settings.wavelengths, (wavelengths) => change({wavelengths}))));
  }
  if (settings.max_depth !== undefined) {
    tab.append(
        row('Longest path', number_field(settings.max_depth, (value) => value !== null && change({max_depth: value})),
            element('span', {class: 'quiet'}, 'vertices')));
  }
  return () => {
    pause.textContent = is_paused() ? 'Go on' : 'Pause';
    pause.disabled = state.status?.state === 'done' || state.status?.state === 'failed';
  };
}

export const render_shape = () =>
    JSON.stringify([state.scene.settings, state.scene.choices?.backends, state.scene.channels]);

export async function copy_camera() {
  try {
    const text = await (await get('/api/camera.xml')).text();
    await navigator.clipboard.writeText(text);
    notice('The camera is in the clipboard, as XML for a scene file.');
  } catch (error) {
    if (error.name === 'NotAllowedError')
      notice('The browser does not allow writing to the clipboard.', 'error');
    else
      show_error(error);
  }
}

const vector_text = (vector) =>
    (vector ? vector.map((v) => String(Number(v.toPrecision(5))).replace('-', '−')).join(',  ') : '–');

export function camera_tab(tab) {
  const fact = (text) => {
    const shown = element('output', {class: 'vector'});
    return [element('div', {class: 'row'}, element('span', {class: 'label'}, text), shown), shown];
  };
  const [origin_row, origin] = fact('Position');
  const [target_row, target] = fact('Looks at');
  const [up_row, up] = fact('Upwards');
  tab.append(element(
      'div', {class: 'row alone'}, button('Reset', reset_camera, {title: 'Home', class: 'wide'}),
      button('Copy as XML', copy_camera, {title: 'C', class: 'wide'})));
  let field = null;
  let slider = null;
  if (typeof state.scene.camera.fov_deg === 'number') {
    slider = element('input', {
      type: 'range',
      min: 2,
      max: 120,
      step: 0.5,
      oninput: () => move_to({fov_deg: Number(slider.value)}),
      onchange: rest
    });
    field = element('output', {class: 'amount'});
    tab.append(row('Field of view', slider, field));
  }
  tab.append(origin_row, target_row, up_row);
  return () => {
    const camera = state.camera ?? state.scene.camera;
    origin.textContent = vector_text(camera.origin);
    target.textContent = vector_text(camera.target);
    up.textContent = vector_text(camera.up);
    if (!slider) return;
    if (slider !== document.activeElement || Number(slider.value) !== camera.fov_deg) slider.value = camera.fov_deg;
    field.textContent = `${tick_text(camera.fov_deg, 0.1)}°`;
  };
}

const kFormats = [
  ['exr', 'EXR', 'All channels, OpenEXR'], ['envi', 'ENVI', 'All channels, ENVI (.hdr and .img)'],
  ['png', 'PNG', 'The picture as it is shown']
];

export function save_tab(tab) {
  const stem = element('input', {type: 'text', spellcheck: 'false', autocomplete: 'off'});
  stem.value = state.save_name ?? state.scene.name.replace(/\.[^.]*$/, '');
  stem.addEventListener('input', () => set({save_name: stem.value}));
  stem.addEventListener('keydown', (event) => event.key === 'Enter' && save());
  const format = choice('Format', kFormats, state.save_format ?? 'exr', (value) => {
    set({save_format: value});
    format.select(value);
  });
  const list = element('ul', {class: 'files', 'aria-label': 'Files saved'});
  const go = button('Save', save, {class: 'wide primary', title: 'Ctrl+S opens this tab, Enter saves'});
  async function save() {
    if (go.disabled) return;  // Enter comes again while a file is written
    go.disabled = true;
    const kind = state.save_format ?? 'exr';
    const answer =
        await post('/api/save', {format: kind, name: stem.value, ...(kind === 'png' ? frame_parameters() : {})});
    go.disabled = false;
    if (!answer) return;
    set({saved: [...(state.saved ?? []), ...answer.files]});
  }
  tab.append(row('Name', stem), row('Format', format), element('div', {class: 'row alone'}, go), list);
  return () => list.replaceChildren(...(state.saved ?? []).map((file) => element('li', {}, `Saved: ${file}`)));
}
