// Requests to the server. Whatever goes wrong is shown (notices.js) with the server's own words, and thrown.
import {adapted} from './adapt.js';
import {notice} from './notices.js';
import {image_mark, set, state} from './state.js';

const kSceneSpacing_ms = 150;  // between two readings of /api/scene
const kGone_ms = 1000;         // so long the stream of events has to say that the server has gone

let losses = 0;  // of the stream of events

export class ServerError extends Error {
  constructor(message, status) {
    super(message);
    this.status = status;
  }
}

/** Whether the server has refused a request, as it would again. */
export const is_refusal = (error) => error instanceof ServerError && error.status >= 400 && error.status < 500;

async function checked(response) {
  if (response.ok) return response;
  let message = `${response.status} ${response.statusText}`;
  const text = await response.text();
  try {
    message = JSON.parse(text).error ?? message;
  } catch {
    if (text && text.length < 500) message = text;
  }
  throw new ServerError(message, response.status);
}

/** The response to GET `path`?`parameters`. Throws ServerError; TypeError when nobody answers; AbortError. */
export async function get(path, parameters = {}, signal = undefined) {
  const query = new URLSearchParams(parameters).toString();
  return checked(await fetch(query ? `${path}?${query}` : path, {signal, cache: 'no-store'}));
}

export const get_json = async (...given) => (await get(...given)).json();

/** POSTs `body` (an object; a text for uploads). Shows errors; returns the answer, or null after an error. */
export async function post(path, body) {
  const text = typeof body === 'string';
  try {
    const response = await checked(
        await fetch(path, {
          method: 'POST',
          headers: {'Content-Type': text ? 'text/plain' : 'application/json', 'X-Kiloband': '1'},
          body: text ? body : JSON.stringify(body),
        }),
    );
    const answer = await response.text();
    return answer ? JSON.parse(answer) : {};
  } catch (error) {
    show_error(error);
    return null;
  }
}

export function show_error(error) {
  if (error.name === 'AbortError') return;
  if (error instanceof ServerError) return notice(error.message, 'error');
  // Where the server has gone, the stream of events has said so (status.js), or does it now, and this says nothing,
  // even if the server has come back meanwhile.
  if (!state.connected) return;
  const before = losses;
  setTimeout(() => losses === before && notice(`The request failed: ${error.message}`, 'error'), kGone_ms);
}

let source = null;
let wait_ms = 500;
let loading = null;  // promise while /api/scene is read
let scene_wanted = false;

async function load_while_wanted() {
  try {
    while (scene_wanted) {
      scene_wanted = false;
      const asked_ms = performance.now();
      set({...adapted(await get_json('/api/scene')), scene_asked_ms: asked_ms});
      await new Promise((resolve) => setTimeout(resolve, kSceneSpacing_ms));
    }
  } catch (error) {
    show_error(error);
  } finally {
    loading = null;
  }
}

/** Reads /api/scene; calls that come while it is being read are one more reading. Settles when the last is done. */
export function load_scene() {
  scene_wanted = true;
  loading ??= load_while_wanted();
  return loading;
}

/**
 * After a refusal: whether the image has become another since the request was made, at this image_mark(). The page did
 * not know yet, and who made the request makes it again.
 */
export async function is_outdated(error, mark) {
  if (!is_refusal(error)) return false;
  await load_scene();
  return image_mark() !== mark;
}

/** The words with which a server that is there refuses this page; '' where it does not. */
async function words_of_refusal() {
  try {
    await get('/api/scene');
  } catch (error) {
    if (error instanceof ServerError) return error.message;
  }
  return '';
}

/** Keeps the stream of events open while the page is visible, and opens it again when the server comes back. */
export function connect() {
  if (source || document.hidden) return;
  source = new EventSource('/api/events');
  source.onopen = () => {
    wait_ms = 500;
    set({connected: true, refusal: ''});
    load_scene();
  };
  source.onerror = () => {
    const answered = source.readyState === EventSource.CLOSED;  // with something else than a stream
    disconnect();
    ++losses;
    set({connected: false});
    (answered ? words_of_refusal() : Promise.resolve('')).then((refusal) => set({refusal}));
    setTimeout(connect, wait_ms);
    wait_ms = Math.min(2 * wait_ms, 4000);
  };
  source.addEventListener('status', (event) => {
    set({status: JSON.parse(event.data)});
    if (!state.scene) load_scene();
  });
  source.addEventListener('scene', load_scene);
  source.addEventListener('frame', (event) => set({announced: JSON.parse(event.data)}));
}

function disconnect() {
  source?.close();
  source = null;
}

document.addEventListener('visibilitychange', () => (document.hidden ? disconnect() : connect()));
addEventListener('pagehide', disconnect);
