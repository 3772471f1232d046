// Frames are pulled: the next one is asked for when the last has been painted, so a slow page gets fewer, and none
// waits for it. While the render goes on fast they are JPEG; paused, finished or slow they are exact.
import {get, is_outdated, is_refusal, show_error} from './api.js';
import {show_bitmap} from './image.js';
import {frame_parameters, image_mark, is_rendering, on, set, state} from './state.js';

const kFast = {
  above: 2.5,
  below: 1.5
};  // frames per second from which on, and down to which, frames are JPEG
let wake = () => {};
let waiting = null;    // AbortController of a request that waits for a frame that is not there yet
let shown_query = '';  // parameters of the frame that is shown
let shown_number = 0;
let refused = '';  // by the server, which would refuse it again

let fast = false;
function quality() {
  const rate = state.status?.frames_per_second ?? 0;
  fast = is_rendering() && rate > (fast ? kFast.below : kFast.above);
  return fast ? 'lossy' : 'exact';
}

function query_of_view() {
  return {...frame_parameters(), quality: quality()};
}

/** What the server's answer depends on. */
const asked_for = () => JSON.stringify([frame_parameters(), image_mark()]);

/** What to ask for next; null if there is nothing new to be had. */
function next_request() {
  if (document.hidden || !state.connected || !state.scene || asked_for() === refused) return null;
  const query = query_of_view();
  const text = JSON.stringify(query);
  if (text !== shown_query) return {query, text, after: 0};
  if (is_rendering() || (state.announced?.frame ?? 0) > shown_number) return {query, text, after: shown_number};
  return null;
}

async function painted() {
  await new Promise((resolve) => {
    requestAnimationFrame(() => resolve());
    setTimeout(resolve, 250);  // a page that is not visible paints nothing
  });
}

async function show_next(request) {
  const abort = new AbortController();
  if (request.after > 0) waiting = abort;
  try {
    const response = await get('/api/frame', {...request.query, after: request.after}, abort.signal);
    waiting = null;
    if (response.status === 204) {
      if (request.after === 0) await until_woken(500);
      return;
    }
    const header = JSON.parse(response.headers.get('X-Kiloband-Frame'));
    const bitmap = await createImageBitmap(await response.blob());
    shown_query = request.text;
    shown_number = header.frame;
    show_bitmap(bitmap, header);
    set({frame: {...header, mode: request.query.mode, parameters: request.query}});
    await painted();
  } finally {
    waiting = null;
  }
}

const until_woken = (limit_ms) => new Promise((resolve) => {
  wake = resolve;
  if (limit_ms) setTimeout(resolve, limit_ms);
});

/** Runs as long as the page. */
export async function pull_frames() {
  for (;;) {
    const request = next_request();
    if (!request) {
      await until_woken(0);
      continue;
    }
    const [asked, mark] = [asked_for(), image_mark()];
    try {
      await show_next(request);
    } catch (error) {
      if (error.name === 'AbortError' || await is_outdated(error, mark)) continue;
      show_error(error);
      if (is_refusal(error))
        refused = asked;
      else
        await until_woken(1000);
    }
  }
}

on('view scene status announced connected', () => {
  if (waiting && JSON.stringify(query_of_view()) !== shown_query) waiting.abort();
  wake();
});
on('connected', () => {
  refused = '';
  shown_query = '';  // a server that was started anew counts from 1
  shown_number = 0;
  waiting?.abort();
});
document.addEventListener('visibilitychange', () => wake());
