// How the view follows the scene: what it starts with, and what becomes of it when there are other channels or modes.
import {fitting, span_of, state} from './state.js';

const kMicrometresFrom_nm = 2500;
let named = '';

export const memory_key = (scene) => `kiloband ${scene.name} ${scene.width} ${scene.height}`;

/** What the last visit has left (memory.js); {} if nothing. */
export function recall(scene) {
  try {
    return JSON.parse(localStorage.getItem(memory_key(scene))) ?? {};
  } catch (error) {
    console.warn('what was kept of the last visit is not used:', error);
    return {};
  }
}

/** Whether each of the three ranges of false colour overlaps a channel. */
const overlap = (ranges, channels) => Object.values(ranges).every(
    ([low, high]) => channels.some(({derived, min_nm, max_nm}) => !derived && min_nm < high && low < max_nm));

/**
 * Changes of the state that go with this scene, in the moment in which it is set: no channel that it lacks is ever
 * shown.
 */
export function adapted(scene) {
  const {modes, channels} = scene;
  const span = span_of(channels);
  const first = !named;
  const kept = first ? recall(scene) : {};
  const view = {...state.view, ...kept.view};
  const text = `${channels.length} ${span.join(' ')}`;
  const changes = {scene};
  if (text !== named) {
    if (!first || (view.ranges && !overlap(view.ranges, channels))) view.ranges = null;
    if (!first || !kept.view || !channels[view.channel]) view.channel = Math.floor(channels.length / 2);
    if (first) changes.plot = {...state.plot, micrometres: span[1] > kMicrometresFrom_nm, ...kept.plot};
    changes.channels_changed = !first;
    named = text;
  }
  view.channel = Math.min(view.channel, channels.length - 1);
  if (!modes.includes(view.mode)) {
    view.mode = modes.includes('temperature') && !modes.includes('color') ? 'temperature' : modes[0];
  }
  changes.view = fitting(view, channels);
  // Nobody is told of a view that stays as it is.
  if (JSON.stringify(changes.view) === JSON.stringify(state.view)) delete changes.view;
  return changes;
}
