// Elements of the panel.

/** An element with attributes (on...: listeners; class; others as they are) and children (elements or texts). */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on'))
      made.addEventListener(name.slice(2), value);
    else if (value === true)
      made.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined)
      made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

let ids = 0;
/** A control with its label before it and what belongs to it (a unit, a value) behind. */
export function row(text, control, ...more) {
  control.id ||= `control-${++ids}`;
  return element('div', {class: 'row'}, element('label', { for: control.id
                 }, text), element('div', {class: 'field'}, control, ...more));
}

/** Buttons of which one is pressed; `choices`: [[value, text, title]]. */
export function choice(label, choices, value, changed) {
  const group = element('div', {class: 'choice', role: 'radiogroup', 'aria-label': label});
  const select = (chosen) => {
    for (const button of group.children) {
      const is = button.dataset.value === String(chosen);
      button.setAttribute('aria-checked', is);
      button.tabIndex = is ? 0 : -1;
    }
  };
  for (const [own, text, title] of choices) {
    group.append(element('button', {role: 'radio', title, 'data-value': own, onclick: () => changed(own)}, text));
  }
  group.addEventListener('keydown', (event) => {
    const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
    const at = [...group.children].indexOf(document.activeElement);
    if (!step || at < 0) return;
    const next = group.children[(at + step + group.children.length) % group.children.length];
    next.focus();
    next.click();
    event.preventDefault();
    event.stopPropagation();
  });
  select(value);
  group.select = select;
  return group;
}

export function select(options, value, changed) {
  const made = element('select', {onchange: () => changed(made.value)});
  for (const [own, text] of options)
    made.append(element('option', {value: own, selected: String(own) === String(value)}, text));
  return made;
}

/**
 * A number that is typed: `changed` gets the number, or null for an empty field; what is no number is marked, not
 * sent.
 */
export function number_field(value, changed, attributes = {}) {
  const made = element(
      'input',
      {type: 'text', inputmode: 'decimal', class: 'number', autocomplete: 'off', spellcheck: 'false', ...attributes});
  made.value = value ?? '';
  made.addEventListener('change', () => {
    const text = made.value.trim().replace('−', '-');
    const number = text === '' ? null : Number(text);
    const wrong = number !== null && !Number.isFinite(number);
    made.classList.toggle('wrong', wrong);
    made.setAttribute('aria-invalid', wrong);
    if (!wrong) changed(number);
  });
  return made;
}

export const button = (text, action, attributes = {}) => element('button', {onclick: action, ...attributes}, text);

/** Gives a blob to the user as a file. */
export function download(blob, name) {
  const link = element('a', {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
