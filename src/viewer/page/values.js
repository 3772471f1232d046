// Numbers in the pixels at high zoom: what the mode shows before exposure and tone, from the server, never read off the
// colours.
import {get_json, is_outdated, is_refusal, ServerError, show_error} from './api.js';
import {number} from './format.js';
import {frame_parameters, image_mark, is_between_images, set, state} from './state.js';

const kMinScale = 46;  // CSS pixels per film pixel
const kMaxPixels = 1024;
const kSpacing_ms = 200;
let held = null;     // {x0, y0, x1, y1, width, components, values, text of the request}
let offered = true;  // false once the server has said that it has no such request
let busy = false;
let refused = '';  // by the server, which would refuse it again
let wanted = null;

export function values_fit({x0, y0, x1, y1}, scale) {
  return offered && scale >= kMinScale && (x1 - x0 + 1) * (y1 - y0 + 1) <= kMaxPixels;
}

function ask(sight) {
  wanted = {...frame_parameters(), ...sight};
  const text = JSON.stringify([wanted, state.frame?.frame, image_mark()]);
  if (!busy && held?.text !== text && refused !== text) fetch_values(text);
}

async function fetch_values(text) {
  busy = true;
  const mark = image_mark();
  try {
    const given = wanted;
    held = {...given, ...(await get_json('/api/values', given)), text};
    set({values: held.frame});
  } catch (error) {
    if (is_refusal(error)) refused = text;
    if (error instanceof ServerError && error.status === 404)
      offered = false;
    else if (!await is_outdated(error, mark) && !is_between_images())
      show_error(error);
  }
  setTimeout(() => {
    busy = false;
    set({values: null});  // drawn again, which asks again if it has changed
  }, kSpacing_ms);
}

/** Errors in per cent, as at the colour bar. */
function value_text(value, mode) {
  if (mode !== 'error' || value === null) return number(value, 3);
  return `${number(100 * value, 3)} %`;
}

function lines_at(x, y) {
  if (!held || x < held.x0 || y < held.y0 || x > held.x1 || y > held.y1 || held.mode !== state.view.mode) return [];
  const first = ((y - held.y0) * held.width + (x - held.x0)) * held.components;
  return held.values.slice(first, first + held.components).map((value) => value_text(value, held.mode));
}

/** Writes the numbers of the pixels in sight, dark on light ones and light on dark ones. */
export function draw_values(context, sight, place, luminance_at) {
  ask(sight);
  const size = Math.min(15, Math.max(8, place.scale / 5.6));
  context.font = `${size}px system-ui, sans-serif`;
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  for (let y = sight.y0; y <= sight.y1; ++y) {
    for (let x = sight.x0; x <= sight.x1; ++x) {
      const lines = lines_at(x, y);
      context.fillStyle = luminance_at(x, y) > 0.45 ? '#000' : '#fff';
      lines.forEach((line, i) => {
        const shift = (i - (lines.length - 1) / 2) * 1.2 * size;
        context.fillText(
            line, place.x + (x + 0.5) * place.scale, place.y + (y + 0.5) * place.scale + shift, place.scale - 4);
      });
    }
  }
  context.textAlign = 'start';
}
