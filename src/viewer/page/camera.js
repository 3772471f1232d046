// The camera as the page moves it: orbit, pan, dolly, look about, fly. The server is told the newest position only, one
// request at a time; `moving` asks for reduced cost until the movement has ended.
import {load_scene, post} from './api.js';
import {film_size, image_scale} from './image.js';
import {on, set, state} from './state.js';
import {add, cross, dot, length, minus, rotated, scaled, unit} from './vectors.js';

const kRest_ms = 180;      // so long after the last step the movement has ended
const kMinCosine = 0.999;  // of the angle to the upward axis: the camera never looks along it
let pivot = null;
let sending = null;   // promise while there is something to send
let answered_ms = 0;  // when the server has last answered to a camera of ours
let unsent = null;
let rest_timer = 0;
let moving = false;

export const has_camera = () => Boolean(state.scene?.camera);

/** The server's camera counts unless it was asked for before it knew ours. */
on('scene', () => {
  if (!has_camera() || moving || sending || state.scene_asked_ms < answered_ms) return;
  const pivot_text = JSON.stringify(state.scene.camera.pivot);
  if (pivot_text !== state.pivot_text) pivot = state.scene.camera.pivot;
  set({camera: state.scene.camera, pivot_text});
});

async function send_all() {
  while (unsent) {
    const body = unsent;
    unsent = null;
    if (!(await post('/api/camera', body))) unsent = null;
  }
  sending = null;
  answered_ms = performance.now();
  load_scene();
}

function send(body) {
  unsent = body;
  sending ??= send_all();
}

function tell(still) {
  const {origin, target, up, fov_deg} = state.camera;
  const lens = fov_deg === undefined || fov_deg === null ? {} : {fov_deg};
  send({origin, target, up, ...lens, moving: !still});
}

/** Sets members of the camera as one step of a movement. */
export function move_to(change) {
  set({camera: {...state.camera, ...change}});
  moving = true;
  tell(false);
  clearTimeout(rest_timer);
  rest_timer = setTimeout(rest, kRest_ms);
}

/** Ends a movement: full cost again. */
export function rest() {
  clearTimeout(rest_timer);
  if (!moving) return;
  moving = false;
  tell(true);
}

function axes() {
  const {origin, target, up} = state.camera;
  const forward = unit(minus(target, origin));
  const right = unit(cross(forward, up));
  return {forward, right, above: cross(right, forward), up: unit(up)};
}

const pivot_distance = () =>
    Math.max(1e-6 * state.camera.scale_m, length(minus(pivot ?? state.camera.target, state.camera.origin)));

/** Angles in radians; positive: the scene turns to the right and downwards under the mouse. */
export function orbit(around, over) {
  const {right, up, forward} = axes();
  const centre = pivot ?? state.camera.target;
  const tilted = dot(rotated(forward, right, -over), up);
  const turn = (v) => rotated(Math.abs(tilted) < kMinCosine ? rotated(v, right, -over) : v, up, -around);
  const {origin, target} = state.camera;
  move_to({origin: add(centre, turn(minus(origin, centre))), target: add(centre, turn(minus(target, centre)))});
}

/** Turns the camera where it stands. */
export function look(around, over) {
  const {right, up, forward} = axes();
  const {origin, target} = state.camera;
  const tilted = dot(rotated(forward, right, -over), up);
  const lifted = Math.abs(tilted) < kMinCosine ? rotated(minus(target, origin), right, -over) : minus(target, origin);
  move_to({target: add(origin, rotated(lifted, up, -around))});
}

function shift(by, with_pivot) {
  if (with_pivot && pivot) pivot = add(pivot, by);
  move_to({origin: add(state.camera.origin, by), target: add(state.camera.target, by)});
}

/** Moves the camera so that what is at the pivot's distance follows the mouse; CSS pixels. */
export function slide(dx, dy) {
  const {right, above} = axes();
  const half = Math.tan((((state.camera.fov_deg ?? 40) / 2) * Math.PI) / 180);
  const metres = (2 * pivot_distance() * half) / (film_size().width * image_scale());
  shift(add(scaled(right, -dx * metres), scaled(above, dy * metres)), true);
}

/** Towards the pivot by a factor of the distance: 0.9 is closer. */
export function dolly(factor) {
  const distance = Math.max(pivot_distance(), 0.01 * state.camera.scale_m);
  shift(scaled(axes().forward, distance * (1 - factor)), false);
}

/** Steps along the camera's axes, in metres. */
export function fly(sideways, upwards, forwards) {
  const {right, up, forward} = axes();
  shift(add(add(scaled(right, sideways), scaled(up, upwards)), scaled(forward, forwards)), true);
}

export function reset_camera() {
  clearTimeout(rest_timer);
  moving = false;
  pivot = state.scene.camera.pivot;
  send({reset: true});
}
