// What a page that is opened again finds as it was: view, pins, axes. Kept by the browser, by the name of the scene.
import {memory_key, recall} from './adapt.js';
import {pin} from './pins.js';
import {on, state} from './state.js';

const kDelay_ms = 300;
let restored = false;
let timer = 0;

function keep() {
  const kept = {view: state.view, plot: state.plot, pins: state.pins.map((one) => one.select)};
  try {
    localStorage.setItem(memory_key(state.scene), JSON.stringify(kept));
  } catch (error) {
    console.warn('the browser keeps nothing:', error);
  }
}

on('scene', () => {
  if (restored) return;
  restored = true;
  for (const select of recall(state.scene).pins ?? []) pin(select);
});

on('view plot pins', () => {
  if (!restored) return;
  clearTimeout(timer);
  timer = setTimeout(keep, kDelay_ms);
});
