// What the page knows, in one place. Modules change it by set() and are told by on(): no module asks another for its
// state.
const listeners = new Map();

export const state = {
  scene: null,   // GET /api/scene
  status: null,  // last event `status`
  frame: null,   // header of the frame that is shown
  connected: false,
  refusal: '',      // the server's words, where it answers and lets this page see nothing
  curves: [],       // [{key, select, pixels, mean, standard_error}] as last received
  pins: [],         // [{key, select: [x, y] | [x0, y0, x1, y1], letter, colour}]
  hover: null,      // [x, y] of the pixel under the mouse or the keyboard's cursor
  marked: null,     // key of the pin that the legend points at
  tool: 'inspect',  // or 'camera'
  view: {
    mode: 'color',
    channel: 0,
    map: 'viridis',
    scale: 'linear',
    low: '',
    high: '',
    exposure: 0,
    tone: 'srgb',
    ranges: null,  // {r: [lo, hi], g, b} in nm
    grid: true,
  },
  plot: {log_y: false, log_x: false, micrometres: false},
};

/** Calls `listener` whenever one of `names` is set. */
export function on(names, listener) {
  for (const name of names.split(' ')) {
    if (!listeners.has(name)) listeners.set(name, []);
    listeners.get(name).push(listener);
  }
}

/** Sets members of the state and tells who listens, once each. */
export function set(changes) {
  const told = new Set();
  Object.assign(state, changes);
  for (const name of Object.keys(changes)) {
    for (const listener of listeners.get(name) ?? []) {
      if (!told.has(listener)) {
        told.add(listener);
        listener();
      }
    }
  }
}

/**
 * The channel nearest to `wanted` that is no sensor response, which has no temperature; on the way there from `last`
 * if there is one.
 */
function thermal_channel(channels, wanted, last) {
  const found = [...channels.keys()].filter((index) => !channels[index].derived);
  const ahead = found.filter((index) => (index - wanted) * (wanted - last) >= 0);
  const distance = (index) => Math.abs(index - wanted);
  return (ahead.length ? ahead : found).reduce((best, index) => (distance(index) < distance(best) ? index : best));
}

/** The view without what the server would refuse for these channels; `last`: the channel before. */
export function fitting(view, channels, last = view.channel) {
  const fits = {...view};
  if (view.mode === 'temperature' && channels[view.channel]?.derived)
    fits.channel = thermal_channel(channels, view.channel, last);
  if (view.scale === 'log') {
    for (const name of ['low', 'high']) {
      if (!(Number(view[name]) > 0)) fits[name] = '';
    }
  }
  return fits;
}

export const set_view = (changes) =>
    set({view: fitting({...state.view, ...changes}, state.scene?.channels ?? [], state.view.channel)});
export const set_plot = (changes) => set({plot: {...state.plot, ...changes}});

/** Modes that show one number per pixel, by colour map and colour bar. */
export const is_scalar = (mode) => mode === 'channel' || mode === 'error' || mode === 'temperature';
/** Modes of which the view's channel is one parameter. */
export const has_channel = (mode) => mode === 'channel' || mode === 'temperature';

export const is_rendering = () => state.status?.state === 'rendering' || state.status?.state === 'loading';

/** What the server's answers about the image depend on, as far as this page knows. */
export function image_mark() {
  const {name, revision, width, height, channels} = state.scene;
  return [name, revision, width, height, channels.length].join();
}

/** Until there is a frame of the scene that was read last, the server may still have the image before. */
export const is_between_images = () => state.frame?.revision !== state.scene.revision;

export const channel_count = () => state.scene?.channels.length ?? 0;
export const channel_centre = (index) => {
  const channel = state.scene.channels[index];
  return (channel.min_nm + channel.max_nm) / 2;
};

/** Indices of the channels and responses, by rising wavelengths: files have them in any order. */
export const channels_in_order = () =>
    state.scene.channels.map((_, index) => index).sort((a, b) => channel_centre(a) - channel_centre(b));

/** From the least to the greatest wavelength of these channels, nm. */
export const span_of =
    (channels) => [Math.min(...channels.map(({min_nm}) => min_nm)), Math.max(...channels.map(({max_nm}) => max_nm))];

/** The thirds of the channels, long ones red: what false colour starts with. Of fewer than three: all. */
export function default_ranges() {
  const channels = channels_in_order().map((index) => state.scene.channels[index]).filter(({derived}) => !derived);
  const count = channels.length;
  const end = (part) => Math.floor(count / 3) * part + Math.min(part, count % 3);
  const third = (part) => {
    const some = count < 3 ? channels : channels.slice(end(part), end(part + 1));
    return span_of(some).map((nm) => Number(nm.toPrecision(6)));
  };
  return {r: third(2), g: third(1), b: third(0)};
}

/** Parameters of the frame that the view asks for: /api/frame, /api/values, /api/save. */
export function frame_parameters() {
  const view = state.view;
  const parameters = {mode: view.mode};
  if (is_scalar(view.mode)) {
    Object.assign(parameters, {map: view.map, scale: view.scale, low: view.low, high: view.high});
  } else {
    Object.assign(parameters, {exposure: String(Number(view.exposure.toFixed(3))), tone: view.tone});
  }
  if (has_channel(view.mode)) parameters.channel = String(view.channel);
  if (view.mode === 'false') {
    const ranges = view.ranges ?? default_ranges();
    for (const name of 'rgb') parameters[name] = ranges[name].join('-');
  }
  return parameters;
}
