// The keyboard: every action of the page, and the overlay that lists them.
import {fly, has_camera, orbit, reset_camera, rest} from './camera.js';
import {copy_camera, restart, toggle_pause} from './control.js';
import {set_channel, set_exposure, set_mode} from './display.js';
import {element} from './dom.js';
import {film_size, fit, pan, reveal, toggle_full_size, zoom} from './image.js';
import {toggle_unit} from './legend.js';
import {close_notices, notice} from './notices.js';
import {pin, unpin_all, unpin_last} from './pins.js';
import {reset_zoom} from './plot.js';
import {rectangle} from './pointer.js';
import {has_channel, is_scalar, set, set_plot, set_view, state} from './state.js';
import {set_tool} from './status.js';
import {open_tab} from './tabs.js';

const kStop = 1 / 3;
const kMaps = ['viridis', 'cividis', 'magma', 'grey'];
const help = document.getElementById('help');
let corner = null;  // first corner of a rectangle that is selected by keys

function step_channel(by) {
  if (has_channel(state.view.mode))
    set_channel(state.view.channel + by);
  else if (state.scene.modes.includes('channel'))
    set_mode('channel');
}

function cursor(dx, dy) {
  const {width, height} = film_size();
  const [x, y] = state.hover ?? [Math.floor(width / 2), Math.floor(height / 2)];
  const hover = [Math.min(width - 1, Math.max(0, x + dx)), Math.min(height - 1, Math.max(0, y + dy))];
  set({hover, hover_by_keys: true, ...(corner ? {selecting: rectangle(corner, hover)} : {})});
  reveal(hover);
}

function arrow(dx, dy, event) {
  if (event.altKey)
    pan(-60 * dx, -60 * dy);
  else if (state.tool === 'camera' && has_camera())
    orbit(0.06 * dx, 0.06 * dy);
  else
    cursor(dx * (event.shiftKey ? 10 : 1), dy * (event.shiftKey ? 10 : 1));
}

function enter() {
  if (!state.hover) return cursor(0, 0);
  pin(corner ? rectangle(corner, state.hover) : state.hover);
  corner = null;
  set({selecting: null});
}

function start_rectangle() {
  cursor(0, 0);
  corner = state.hover;
  set({selecting: rectangle(corner, corner)});
}

function escape() {
  corner = null;
  close_notices();
  set({selecting: null, hover: state.hover_by_keys ? null : state.hover, hover_by_keys: false});
}

function automatic() {
  set_view(is_scalar(state.view.mode) ? {low: '', high: ''} : {exposure: 0});
}

function save() {
  if (!open_tab('save', true)) notice('Saving needs the option --output-dir of the program.');
}

const toggle_panel = () => document.body.classList.toggle('bare');
const toggle_full_screen = () =>
    (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen());
const next_map = () => set_view({map: kMaps[(kMaps.indexOf(state.view.map) + 1) % kMaps.length]});
const in_scene = (action) => () => state.scene.kind === 'scene' && action();
const with_camera = (action) => (event) => has_camera() && action(event);

export function show_help() {
  if (help.open) return help.close();
  fill_help();
  help.showModal();
}

/** event.key -> action; letters in lower case, with 'Shift+' before them where it counts. */
const actions = {
  '?': show_help,
  escape,
  i: () => set_tool('inspect'),
  o: with_camera(() => set_tool('camera')),
  '+': () => zoom(1.25),
  '=': () => zoom(1.25),
  '-': () => zoom(0.8),
  0: fit,
  z: toggle_full_size,
  g: () => set_view({grid: !state.view.grid}),
  h: toggle_panel,
  f: toggle_full_screen,
  arrowleft: (event) => arrow(-1, 0, event),
  arrowright: (event) => arrow(1, 0, event),
  arrowup: (event) => arrow(0, -1, event),
  arrowdown: (event) => arrow(0, 1, event),
  enter,
  p: enter,
  r: start_rectangle,
  delete: unpin_last,
  backspace: unpin_last,
  'Shift+delete': unpin_all,
  '[': () => step_channel(-1),
  ']': () => step_channel(1),
  '{': () => step_channel(-10),
  '}': () => step_channel(10),
  ',': () => set_exposure(state.view.exposure - kStop),
  '.': () => set_exposure(state.view.exposure + kStop),
  '/': automatic,
  t: () => set_view({tone: state.view.tone === 'srgb' ? 'filmic' : 'srgb'}),
  m: next_map,
  k: () => set_view({scale: state.view.scale === 'log' ? 'linear' : 'log'}),
  l: () => set_plot({log_y: !state.plot.log_y}),
  'Shift+l': () => set_plot({log_x: !state.plot.log_x}),
  u: toggle_unit,
  y: reset_zoom,
  ' ': in_scene(toggle_pause),
  'Shift+r': in_scene(restart),
  home: with_camera(reset_camera),
  c: with_camera(copy_camera),
};

const kFly = {
  w: [0, 0, 1],
  s: [0, 0, -1],
  a: [-1, 0, 0],
  d: [1, 0, 0],
  e: [0, 1, 0],
  q: [0, -1, 0]
};
const held = new Set();
let flying = false;

function fly_step(last) {
  requestAnimationFrame((now) => {
    if (held.size === 0) {
      flying = false;
      return rest();
    }
    const seconds = Math.min(0.1, Math.max(0, now - last) / 1000);
    const speed = 0.6 * state.camera.scale_m * (state.fast ? 4 : 1) * seconds;
    const sum = [0, 1, 2].map((i) => [...held].reduce((total, key) => total + kFly[key][i], 0) * speed);
    if (sum.some((v) => v !== 0)) fly(...sum);
    fly_step(now);
  });
}

function start_flying(key, fast) {
  state.fast = fast;
  held.add(key);
  if (flying) return;
  flying = true;
  fly_step(performance.now());
}

/** Whether the focus is where keys mean something of their own. */
function is_taken(event) {
  const target = event.target;
  if (target.matches('input[type=text], select, textarea')) return event.key !== 'Escape';
  if (target.matches('input[type=range]'))
    return event.key.startsWith('Arrow') || event.key === 'Home' || event.key === 'End';
  if (target.matches('button, input, a, [role=tab]'))
    return event.key === 'Enter' || event.key === ' ' ||
        (target.matches('[role=tab], [role=radio]') && event.key.startsWith('Arrow'));
  return false;
}

function key_down(event) {
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 's') {
    event.preventDefault();
    return save();
  }
  if (!state.scene || event.ctrlKey || event.metaKey || (help.open && event.key !== '?') || is_taken(event)) return;
  if (event.key === 'Escape' && event.target.matches('input[type=text], select')) event.target.blur();
  const key = event.key.toLowerCase();
  if (kFly[key] && has_camera()) return start_flying(key, event.shiftKey);
  const mode = /^[1-9]$/.test(key) ? state.scene.modes[Number(key) - 1] : null;
  const action = mode ? () => set_mode(mode) : (event.shiftKey && actions[`Shift+${key}`]) || actions[key];
  if (!action) return;
  event.preventDefault();
  action(event);
}

addEventListener('keydown', key_down);
addEventListener('keyup', (event) => held.delete(event.key.toLowerCase()));
addEventListener('blur', () => held.clear());
document.getElementById('help-button').onclick = show_help;
help.addEventListener('click', (event) => event.target === help && help.close());

const kHelp = [
  [
    'Image',
    [
      ['+  −  wheel', 'Zoom'], ['drag, Alt + arrows', 'Move it'], ['0', 'Whole image'], ['Z', 'One pixel to one pixel'],
      ['G', 'Pixel grid'], ['H', 'Hide the panel'], ['F', 'Full screen']
    ]
  ],
  [
    'Display',
    [
      ['1 … 9', 'Mode'], ['[  ]', 'Channel; with Shift by ten'], [',  .', 'Exposure'],
      ['/', 'Automatic exposure or range'], ['T', 'Tone curve'], ['M', 'Colour map'],
      ['K', 'Colours linear, logarithmic']
    ]
  ],
  [
    'Spectra',
    [
      ['click, Enter', 'Pin a pixel'], ['arrows', 'Move the cursor; with Shift by ten'],
      ['Shift-drag', 'Pin a rectangle'], ['R, then Enter', 'The same by the cursor'],
      ['Delete', 'Let the last pin go; with Shift all'], ['L, Shift + L', 'Logarithmic y, x'], ['U', 'nm, µm'],
      ['drag, Y', 'Zoom the plot, whole range'], ['click in the plot', 'Show that channel']
    ]
  ],
];
const kSceneHelp = [
  [
    'Camera',
    [
      ['O, I', 'Camera tool, inspecting tool'], ['drag, arrows', 'Orbit'], ['Shift-drag', 'Pan'], ['wheel', 'Dolly'],
      ['right button', 'Look about'], ['W A S D, Q E', 'Fly; with Shift faster'], ['Home', 'Reset'],
      ['C', 'Copy as XML']
    ]
  ],
  ['Rendering', [['Space', 'Pause, go on'], ['Shift + R', 'Restart']]],
];

function fill_help() {
  const groups = [...kHelp, ...(state.scene?.kind === 'scene' ? kSceneHelp : [])];
  groups.push(['Page', [['Ctrl + S', 'Save'], ['Esc', 'Close messages'], ['?', 'This list']]]);
  const list = ([title, keys]) => element(
      'section', {}, element('h2', {}, title),
      element('dl', {}, ...keys.flatMap(([key, text]) => [element('dt', {}, key), element('dd', {}, text)])));
  const close = element('button', {class: 'plain close', 'aria-label': 'Close', onclick: () => help.close()}, '×');
  help.replaceChildren(close, element('div', {class: 'groups'}, ...groups.map(list)));
}
