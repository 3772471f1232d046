// Pinned pixels and rectangles, and the spectra of what is pinned or under the mouse.
import {get_json, is_outdated, is_refusal, show_error} from './api.js';
import {notice} from './notices.js';
import {channel_count, image_mark, is_between_images, is_rendering, on, set, state} from './state.js';

const kMaxPins = 15;  // with the pixel under the mouse as many as the server answers at once
const kRefresh_ms = 300;
// Okabe and Ito's colours, which colour-blind people can tell apart; the yellow and black of the set are left out.
const kColours = ['#e69f00', '#56b4e9', '#009e73', '#d55e00', '#cc79a7', '#0072b2'];
let busy = false;
let stale = false;  // something has changed since the last request was made
let refused = '';   // by the server, which would refuse it again
let last_ms = 0;
let timer = 0;

const key_of = (select) => select.join(',');

/** Pins a pixel [x, y] or a rectangle [x0, y0, x1, y1]; one that is pinned already is let go. */
export function pin(select) {
  const whole = select.length === 4 && select[0] === select[2] && select[1] === select[3] ? select.slice(0, 2) : select;
  const key = key_of(whole);
  if (state.pins.some((old) => old.key === key)) return unpin(key);
  if (state.pins.length >= kMaxPins)
    return notice(`At most ${kMaxPins} spectra are shown at once; Delete lets the last one go.`);
  const used = new Set(state.pins.map((old) => old.index));
  let index = 0;
  while (used.has(index)) ++index;
  const added = {
    key,
    select: whole,
    index,
    letter: String.fromCharCode(65 + index),
    colour: kColours[index % kColours.length],
    dash: Math.floor(index / kColours.length)
  };
  set({pins: [...state.pins, added]});
}

export const unpin = (key) => set({pins: state.pins.filter((old) => old.key !== key), marked: null});
export const unpin_last = () => set({pins: state.pins.slice(0, -1), marked: null});
export const unpin_all = () => set({pins: [], marked: null});

/** What the plot shows: the pins, and the pixel under the mouse unless it is pinned. */
export function selections() {
  const hover = state.hover && {key: key_of(state.hover), select: state.hover, letter: '', colour: null, dash: 0};
  return hover && !state.pins.some((old) => old.key === hover.key) ? [...state.pins, hover] : state.pins;
}

export const place_text = ({select}) =>
    select.length === 2 ? `${select[0]}, ${select[1]}` : `${select[0]}, ${select[1]} – ${select[2]}, ${select[3]}`;

async function refresh() {
  if (busy) return;
  const wanted = selections().map((selection) => selection.key);
  if (wanted.length === 0 || !state.scene || !state.connected) {
    if (wanted.length === 0 && state.curves.length) set({curves: []});
    return;
  }
  const mark = image_mark();
  const asked = [mark, state.frame?.frame, ...wanted].join(';');
  if (asked === refused) return;
  busy = true;
  stale = false;
  last_ms = performance.now();
  try {
    const answer = await get_json('/api/spectra', {select: wanted.join(';')});
    const curves = answer.curves.filter((curve) => curve.mean.length === channel_count());
    set({curves, curves_of: {frame: answer.frame, revision: answer.revision, samples: answer.samples}});
  } catch (error) {
    if (is_refusal(error)) refused = asked;
    if (!await is_outdated(error, mark) && !is_between_images()) show_error(error);
  } finally {
    busy = false;
    if (stale) schedule(40);
  }
}

function schedule(delay_ms) {
  stale = true;
  if (busy) return;
  clearTimeout(timer);
  timer = setTimeout(refresh, delay_ms);
}

on('pins hover connected', () => schedule(0));
on('scene', () => {
  const {width, height} = state.scene;
  const is_inside = (select) =>
      Math.max(select[0], select[2] ?? 0) < width && Math.max(select[1], select[3] ?? 0) < height;
  const inside = state.pins.filter(({select}) => is_inside(select));
  if (inside.length < state.pins.length) set({pins: inside});
  if (state.hover && !is_inside(state.hover)) set({hover: null, hover_by_keys: false, selecting: null});
  schedule(0);
});
on('frame', () => {
  if (state.frame.frame === state.curves_of?.frame) return;
  schedule(is_rendering() ? Math.max(0, kRefresh_ms - (performance.now() - last_ms)) : 0);
});
