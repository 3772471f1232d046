// The mouse over the image. Inspect: click pins, Shift-drag selects a rectangle, drag pans, wheel zooms. Camera: drag
// orbits, Shift-drag or the middle button pans, the right button looks about, wheel dollies; with Ctrl the wheel zooms
// the image.
import {dolly, has_camera, look, orbit, rest, slide} from './camera.js';
import {nearest_pixel, pan, pixel_at, zoom} from './image.js';
import {pin} from './pins.js';
import {set, state} from './state.js';

const canvas = document.getElementById('image');
const kClick_px = 4;  // a press that moves less is a click
const kRadiansPerPixel = 0.008;
let press = null;  // {x, y, button, action, first}

const at = (event) => [event.offsetX, event.offsetY];

function action_of(event) {
  if (state.tool === 'camera' && has_camera()) {
    if (event.button === 2) return 'look';
    return event.button === 1 || event.shiftKey ? 'slide' : 'orbit';
  }
  if (event.button === 0 && event.shiftKey) return 'select';
  return 'pan';
}

canvas.addEventListener('pointerdown', (event) => {
  canvas.setPointerCapture(event.pointerId);
  canvas.focus({preventScroll: true});
  const [x, y] = at(event);
  press = {x, y, moved: 0, button: event.button, action: action_of(event), first: nearest_pixel(x, y)};
  event.preventDefault();
});

canvas.addEventListener('pointermove', (event) => {
  const [x, y] = at(event);
  if (!press) {
    const hover = pixel_at(x, y);
    if (String(hover) !== String(state.hover)) set({hover, hover_by_keys: false});
    return;
  }
  const [dx, dy] = [x - press.x, y - press.y];
  press.moved += Math.abs(dx) + Math.abs(dy);
  if (press.moved < kClick_px) return;
  Object.assign(press, {x, y});
  canvas.classList.add('dragging');
  drag(dx, dy);
});

function drag(dx, dy) {
  if (press.action === 'pan')
    pan(dx, dy);
  else if (press.action === 'orbit')
    orbit(dx * kRadiansPerPixel, dy * kRadiansPerPixel);
  else if (press.action === 'look')
    look(-dx * kRadiansPerPixel * 0.4, -dy * kRadiansPerPixel * 0.4);
  else if (press.action === 'slide')
    slide(dx, dy);
  else
    set({selecting: rectangle(press.first, nearest_pixel(press.x, press.y)), hover: null});
}

export const rectangle =
    (a, b) => [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[0], b[0]), Math.max(a[1], b[1])];

canvas.addEventListener('pointerup', (event) => {
  if (!press) return;
  const {action, moved, button} = press;
  press = null;
  canvas.classList.remove('dragging');
  rest();
  if (state.selecting) {
    const selecting = state.selecting;
    set({selecting: null});
    pin(selecting);
  } else if (moved < kClick_px && button === 0 && action !== 'select') {
    const pixel = pixel_at(...at(event));
    if (pixel) pin(pixel);
  }
});

canvas.addEventListener('pointercancel', () => {
  press = null;
  canvas.classList.remove('dragging');
  set({selecting: null});
  rest();
});

canvas.addEventListener('pointerleave', () => {
  if (!press && !state.hover_by_keys) set({hover: null});
});

canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      const notches = event.deltaMode === 1 ? event.deltaY * 30 : event.deltaY;
      const factor = Math.exp(-Math.max(-300, Math.min(300, notches)) * 0.0015);
      if (state.tool === 'camera' && has_camera() && !event.ctrlKey)
        dolly(1 / factor);
      else
        zoom(factor, ...at(event));
    },
    {passive: false},
);
canvas.addEventListener('contextmenu', (event) => event.preventDefault());
