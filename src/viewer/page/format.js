// Numbers and units as they are shown.
const kSuperscripts = {
  '-': '⁻',
  0: '⁰',
  1: '¹',
  2: '²',
  3: '³',
  4: '⁴',
  5: '⁵',
  6: '⁶',
  7: '⁷',
  8: '⁸',
  9: '⁹'
};

export const superscript = (value) => [...String(value)].map((c) => kSuperscripts[c] ?? c).join('');

/** "W m-2 sr-1 nm-1" as "W m⁻² sr⁻¹ nm⁻¹"; the unit 1 is none. */
export function unit_text(unit) {
  if (!unit || unit === '1') return '';
  return unit.replace(/([A-Za-zµ])(-?\d+)/g, (all, letter, power) => letter + superscript(power));
}

const kMinus = (text) => text.replace(/^-/, '−');

/** `value` with so many significant digits; powers of ten outside 10⁻³ … 10⁶. */
export function number(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e6) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    return `${kMinus(mantissa)} × 10${superscript(Number(exponent))}`;
  }
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return kMinus(value.toFixed(Math.min(decimals, 12)));
}

/** Value and standard error: the error with two digits, the value to the same place. */
export function with_error(value, error) {
  if (value === null || value === undefined) return '–';
  if (!error || !(error > 0)) return number(value);
  const size = Math.max(Math.abs(value), error);
  let exponent = Math.floor(Math.log10(size));
  if (exponent >= -2 && exponent < 6) exponent = 0;
  const scale = 10 ** exponent;
  const decimals = Math.min(8, Math.max(0, 1 - Math.floor(Math.log10(error / scale))));
  const text = `${kMinus((value / scale).toFixed(decimals))} ± ${(error / scale).toFixed(decimals)}`;
  return exponent === 0 ? text : `(${text}) × 10${superscript(exponent)}`;
}

/** A count: all its digits, in groups of three. */
export const count = (value) =>
    (Number.isFinite(value) ? Math.round(value).toString().replace(/\B(?=(\d{3})+$)/g, '\u202f') : '–');

export function percent(fraction) {
  if (fraction === null || fraction === undefined || !Number.isFinite(fraction)) return '–';
  const value = 100 * fraction;
  return `${value >= 100 ? value.toFixed(0) : Number(value.toPrecision(2))} %`;
}

/** "3.9 M": three digits at most. */
export function large(value) {
  if (!Number.isFinite(value)) return '–';
  for (const [size, prefix] of [[1e9, ' G'], [1e6, ' M'], [1e3, ' k']]) {
    if (value >= size) return `${Number((value / size).toPrecision(3))}${prefix}`;
  }
  return `${Number(value.toPrecision(3))} `.trimEnd();
}

export function bytes(value) {
  if (!Number.isFinite(value)) return '–';
  for (const [size, unit] of [[2 ** 30, 'GiB'], [2 ** 20, 'MiB'], [2 ** 10, 'KiB']]) {
    if (value >= size) return `${Number((value / size).toPrecision(3))} ${unit}`;
  }
  return `${value} B`;
}

export function duration(seconds) {
  if (!Number.isFinite(seconds)) return '–';
  if (seconds < 60) return `${seconds.toFixed(seconds < 10 ? 1 : 0)} s`;
  const minutes = Math.floor(seconds / 60);
  const rest = (count) => String(count).padStart(2, '0');
  if (minutes < 60) return `${minutes}:${rest(Math.floor(seconds % 60))} min`;
  return `${Math.floor(minutes / 60)}:${rest(minutes % 60)} h`;
}

/** A wavelength with its unit. */
export function wavelength(nm, micrometres) {
  return micrometres ? `${Number((nm / 1000).toPrecision(5))} µm` : `${Number(nm.toPrecision(5))} nm`;
}

/** Round numbers between low and high, about `count` of them. */
export function linear_ticks(low, high, count) {
  const span = high - low;
  if (!(span > 0)) return [low];
  const rough = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= rough) ?? 10);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * span; ++i) ticks.push(i * step);
  return ticks;
}

/**
 * Powers of ten between low and high > 0; between few of them their multiples, too; `labelled` says which have text.
 */
export function log_ticks(low, high) {
  if (!(low > 0) || !Number.isFinite(high)) return linear_ticks(low, high, 4);  // there is no power of ten to begin at
  const first = Math.floor(Math.log10(low));
  const last = Math.ceil(Math.log10(high));
  const decades = Math.log10(high / low);
  const multiples = decades < 1.2 ? [1, 2, 3, 4, 5, 6, 7, 8, 9] : decades < 3 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil(decades / 6));
  const ticks = [];
  for (let exponent = first; exponent <= last; ++exponent) {
    for (const factor of multiples) {
      const value = factor * 10 ** exponent;
      if (value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9) && exponent % every === 0) ticks.push(value);
    }
  }
  return ticks.length >= 2 ? ticks : linear_ticks(low, high, 4);
}

/** The power of ten that ticks up to `size` share: 0 where plain numbers are short. */
export function shared_exponent(size) {
  if (!(size > 0) || !Number.isFinite(size)) return 0;
  const exponent = Math.floor(Math.log10(size));
  return exponent < -1 || exponent > 3 ? 3 * Math.floor(exponent / 3) : 0;
}

/** A tick of an axis whose step is known: so many decimals as the step has. */
export function tick_text(value, step, scale = 1) {
  const scaled = value / scale;
  const decimals = Math.max(0, Math.min(8, -Math.floor(Math.log10(Math.abs(step / scale) * (1 + 1e-9)))));
  return kMinus(Number(scaled.toFixed(decimals)) === 0 ? '0' : scaled.toFixed(decimals));
}

/** A tick of a logarithmic axis. */
export function log_text(value) {
  const exponent = Math.floor(Math.log10(value) + 1e-9);
  const factor = value / 10 ** exponent;
  if (exponent >= -2 && exponent <= 4) return String(Number(value.toPrecision(6)));
  const power = `10${superscript(exponent)}`;
  return Math.abs(factor - 1) < 1e-6 ? power : `${Number(factor.toPrecision(3))}·${power}`;
}
