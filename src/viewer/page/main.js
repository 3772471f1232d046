// The page of `kiloband view`: modules know the state (state.js) and are told when it changes; this one starts them.
import './pointer.js';
import './colorbar.js';
import './legend.js';
import './status.js';
import './tabs.js';
import './keys.js';
import './memory.js';

import {connect} from './api.js';
import {pull_frames} from './frames.js';
import {notice} from './notices.js';

addEventListener('error', (event) => notice(`Error of the page: ${event.message}`, 'error'));
addEventListener(
    'unhandledrejection', (event) => notice(`Error of the page: ${event.reason?.message ?? event.reason}`, 'error'));
connect();
pull_frames();
