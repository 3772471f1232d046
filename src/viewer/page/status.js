// The line at the foot: tools, the pixel under the mouse, and how the rendering goes.
import {has_camera} from './camera.js';
import {button, choice, element} from './dom.js';
import {bytes, count, duration, large, number, percent} from './format.js';
import {fit, toggle_full_size} from './image.js';
import {on, set, state} from './state.js';

const id = (name) => document.getElementById(name);
const kStates = {
  loading: 'Loading',
  rendering: 'Rendering',
  paused: 'Paused',
  done: 'Done',
  failed: 'Failed'
};

const kAbsence = id('offline').textContent;

export const set_tool = (tool) => set({tool});

const tool_choice = choice(
    'What the mouse does',
    [
      ['inspect', 'Inspect', 'Click pins, drag moves the image, Shift-drag selects, wheel zooms (I)'],
      ['camera', 'Camera', 'Drag orbits, Shift-drag pans, right button looks about, wheel dollies, W A S D Q E fly (O)']
    ],
    state.tool,
    set_tool,
);
const zoom_text = button(
    '', toggle_full_size, {class: 'plain zoom', title: 'One film pixel per screen pixel, or the whole image (Z)'});
id('tools').append(tool_choice, button('Fit', fit, {title: 'The whole image (0)'}), zoom_text);

function samples_text({samples, target_samples}) {
  const of = target_samples ? ` of ${count(target_samples)}` : '';
  return `${count(samples)}${of} samples per pixel`;
}

/** What renders; a CPU has one method. */
const backend_text = ({backend, method}) => (backend === 'opencl' ? `OpenCL, ${method}` : 'CPU');

/** While the camera moves. */
const is_reduced = () => Boolean(state.frame && state.frame.width < state.frame.full_width);

/** A paused render that has been changed has no picture yet: the one before stays. */
const is_outdated = (status) => status.state === 'paused' && state.frame?.revision < status.revision;

function parts_of(status) {
  const live = status.state === 'rendering';
  const parts = [];
  if (is_outdated(status)) parts.push(['outdated', 'the picture is from before the change']);
  if (is_reduced()) parts.push(['reduced', `reduced to ${state.frame.width} × ${state.frame.height}`]);
  if (state.scene?.kind === 'scene') {
    parts.push(['samples', samples_text(status)], ['time', duration(status.seconds)]);
    if (live)
      parts.push(
          ['paths', `${large(status.paths_per_second)}paths/s`],
          ['frames', `${number(status.frames_per_second, 3)} frames/s`]);
  }
  if (status.error !== null && status.error !== undefined) parts.push(['error', `error ${percent(status.error)}`]);
  if (state.scene?.settings) parts.push(['backend', backend_text(state.scene.settings)]);
  if (status.memory_bytes) parts.push(['memory', bytes(status.memory_bytes)]);
  if (status.clients > 1) parts.push(['clients', `${status.clients} pages`]);
  return parts;
}

function show_status() {
  const status = state.status;
  if (!status) return;
  const word =
      state.scene?.kind === 'cube' && status.state === 'done' ? 'Stored cube' : (kStates[status.state] ?? status.state);
  const head = element('span', {class: `state ${status.state}`}, word);
  const message = status.message ? [element('span', {class: 'message', title: status.message}, status.message)] : [];
  id('status').replaceChildren(
      head, ...message, ...parts_of(status).map(([name, text]) => element('span', {class: name}, text)));
}

function show_pixel() {
  const {hover, scene} = state;
  id('pixel').textContent = hover ? `x ${hover[0]}  y ${hover[1]}` :
      scene ? `${scene.width} × ${scene.height} × ${scene.channels.length}` :
              '';
}

function show_tools() {
  tool_choice.hidden = !has_camera();
  tool_choice.select(state.tool);
  id('stage').classList.toggle('camera-tool', state.tool === 'camera' && has_camera());
  zoom_text.textContent = state.frame && state.zoom ? `${number(100 * state.zoom, 3)} %` : '';
}

on('status scene frame', show_status);
on('hover scene', show_pixel);
on('tool scene zoom frame', show_tools);
on('connected', () => (id('offline').hidden = state.connected));
on('refusal', () => (id('offline').textContent = state.refusal || kAbsence));
on('scene', () => (document.title = `${state.scene.name} – kiloband`));
