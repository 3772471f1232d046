// The plot as a PNG: dygraphs' canvas, with the axes' labels, titles and the legend drawn around it.
import {download} from './dom.js';
import {place_text} from './pins.js';
import {curves_shown, x_title, y_title} from './plot.js';
import {state} from './state.js';

const kRow = 18;  // CSS pixels of a line of the legend
const kMargin = 12;
const kText = 12;

function draw_labels(context, box, left, top) {
  context.font = `${kText}px system-ui, sans-serif`;
  context.textBaseline = 'middle';
  for (const label of box.querySelectorAll('.dygraph-axis-label')) {
    const place = label.getBoundingClientRect();
    const origin = box.getBoundingClientRect();
    const is_y = label.classList.contains('dygraph-axis-label-y');
    context.textAlign = is_y ? 'right' : 'center';
    const x = is_y ? place.right : (place.left + place.right) / 2;
    context.fillText(label.textContent, left + x - origin.left, top + (place.top + place.bottom) / 2 - origin.top);
  }
}

function draw_legend(context, top) {
  context.textAlign = 'left';
  curves_shown().forEach(({selection}, i) => {
    const y = top + (i + 0.5) * kRow;
    const ink = context.fillStyle;
    context.strokeStyle = selection.colour ?? ink;
    context.lineWidth = 2;
    context.setLineDash([[], [7, 3], [2, 3]][selection.dash % 3]);
    context.beginPath();
    context.moveTo(kMargin, y);
    context.lineTo(kMargin + 24, y);
    context.stroke();
    context.setLineDash([]);
    context.fillText(`${selection.letter}  ${place_text(selection)}`.trim(), kMargin + 32, y);
  });
}

/** The plot as it is shown, in the page's colours. */
export function export_png() {
  const box = document.getElementById('plot');
  const plot = box.querySelector('canvas');
  const ratio = plot.width / plot.clientWidth;
  const [width, height] = [plot.clientWidth + 2 * kMargin, plot.clientHeight];
  const top = kMargin + kRow;
  const total = top + height + kRow + curves_shown().length * kRow + kMargin;
  const canvas = document.createElement('canvas');
  Object.assign(canvas, {width: width * ratio, height: total * ratio});
  const context = canvas.getContext('2d');
  context.scale(ratio, ratio);
  const colours = getComputedStyle(document.body);
  context.fillStyle = getComputedStyle(document.getElementById('panel')).backgroundColor;
  context.fillRect(0, 0, width, total);
  context.drawImage(plot, kMargin, top, plot.clientWidth, height);
  context.fillStyle = colours.color;
  draw_labels(context, box, kMargin, top);
  context.textAlign = 'left';
  context.fillText(y_title(), kMargin, kMargin + kRow / 2);
  context.textAlign = 'right';
  context.fillText(x_title(), width - kMargin, top + height + kRow / 2);
  draw_legend(context, top + height + kRow);
  canvas.toBlob((blob) => download(blob, `${state.scene.name.replace(/\.[^.]*$/, '')}_spectra.png`), 'image/png');
}
