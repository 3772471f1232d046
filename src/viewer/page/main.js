// The page of `kiloband view`: modules know the state (state.js) and are told when it changes; this one starts them.
import './pointer.js';
import './colorbar.js';
import './legend.js';
import './status.js';
import './tabs.js';
import './keys.js';

import {connect} from './api.js';
import {pull_frames} from './frames.js';
import {redraw} from './image.js';
import {notice} from './notices.js';
import {on, set_plot, set_view, state} from './state.js';

const kMicrometresFrom_nm = 2500;
let named = '';

/** A scene that is seen for the first time, or one with other channels than before. */
function adapt_view() {
  const {modes, channels, name} = state.scene;
  const change = {};
  if (!modes.includes(state.view.mode))
    change.mode = modes.includes('temperature') && !modes.includes('color') ? 'temperature' : modes[0];
  const text = `${name} ${channels.length} ${channels[0].min_nm} ${channels[channels.length - 1].max_nm}`;
  if (text !== named) {
    if (named || state.view.channel >= channels.length) change.ranges = null;
    change.channel = Math.floor(channels.length / 2);
    if (!named) set_plot({micrometres: channels[channels.length - 1].max_nm > kMicrometresFrom_nm});
    named = text;
  }
  if (Object.keys(change).length) set_view(change);
}

on('scene', adapt_view);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
addEventListener('error', (event) => notice(`Error of the page: ${event.message}`, 'error'));
addEventListener(
    'unhandledrejection', (event) => notice(`Error of the page: ${event.reason?.message ?? event.reason}`, 'error'));
connect();
pull_frames();
