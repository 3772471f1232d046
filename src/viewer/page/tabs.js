// The tabs of the panel. A tab that does not apply to what is shown is not there.
import {camera_tab, render_shape, render_tab, save_tab} from './control.js';
import {display_shape, display_tab} from './display.js';
import {element} from './dom.js';
import {materials_tab} from './materials.js';
import {on, set, state} from './state.js';

const strip = document.getElementById('tabs');
const panel = document.getElementById('tab');
const kTabs = [
  {name: 'image', text: 'Image', applies: () => true, fill: display_tab, shape: display_shape},
  {
    name: 'scene',
    text: 'Materials',
    applies: () => state.scene.spectra?.length > 0,
    fill: materials_tab,
    shape: () => ''
  },
  {
    name: 'camera',
    text: 'Camera',
    applies: () => Boolean(state.scene.camera),
    fill: camera_tab,
    shape: () => typeof state.scene.camera.fov_deg
  },
  {name: 'render', text: 'Render', applies: () => Boolean(state.scene.settings), fill: render_tab, shape: render_shape},
  {
    name: 'save',
    text: 'Save',
    applies: () => Boolean(state.scene.choices?.output),
    fill: save_tab,
    shape: () => state.scene.name
  },
];
let shown = '';  // tab and shape that the panel holds
let sync = () => {};

const present = () => kTabs.filter((tab) => tab.applies());

export function open_tab(name, focus = false) {
  if (!state.scene || !present().some((tab) => tab.name === name)) return false;
  set({tab: name});
  if (focus) (panel.querySelector('input, select, button') ?? panel).focus();
  return true;
}

function strip_keys(event) {
  const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
  const names = present().map((tab) => tab.name);
  if (!step) return;
  open_tab(names[(names.indexOf(state.tab) + step + names.length) % names.length]);
  strip.querySelector('[aria-selected=true]').focus();
  event.preventDefault();
  event.stopPropagation();
}

function show_strip(tabs, chosen) {
  const text = tabs.map((tab) => tab.name).join() + chosen.name;
  if (strip.dataset.shown === text) return;
  strip.dataset.shown = text;
  const had_focus = strip.contains(document.activeElement);
  strip.replaceChildren(
      ...tabs.map(
          (tab) => element(
              'button',
              {
                role: 'tab',
                id: `tab-${tab.name}`,
                'aria-selected': String(tab === chosen),
                'aria-controls': 'tab',
                tabindex: tab === chosen ? 0 : -1,
                onclick: () => open_tab(tab.name)
              },
              tab.text,
              ),
          ),
  );
  if (had_focus) strip.querySelector('[aria-selected=true]').focus();
}

/** The control in the panel that has the focus: its place survives when the panel is built anew. */
function focus_place() {
  const controls = [...panel.querySelectorAll('button, input, select')];
  return controls.indexOf(document.activeElement);
}

function show() {
  if (!state.scene) return;
  const tabs = present();
  const chosen = tabs.find((tab) => tab.name === state.tab) ?? tabs[0];
  show_strip(tabs, chosen);
  const shape = chosen.name + chosen.shape();
  if (shape !== shown) {
    const place = shown.startsWith(chosen.name) ? focus_place() : -1;
    shown = shape;
    panel.replaceChildren();
    panel.classList.toggle('tall', chosen.name === 'scene');
    panel.setAttribute('aria-labelledby', `tab-${chosen.name}`);
    sync = chosen.fill(panel);
    if (place >= 0) [...panel.querySelectorAll('button, input, select')][place]?.focus();
  }
  sync();
}

on('scene tab view frame status camera plot saved edited', show);
