// Messages over the image: errors stay until they are closed, others go by themselves.
const kShownMs = 6000;

/** Shows `text`; the kind is 'error' or 'info'. The same text is shown once. */
export function notice(text, kind = 'info') {
  const list = document.getElementById('notices');
  for (const old of list.children) {
    if (old.dataset.text === text) old.remove();
  }
  const item = document.createElement('div');
  item.className = `notice ${kind}`;
  item.dataset.text = text;
  item.setAttribute('role', kind === 'error' ? 'alert' : 'status');
  const words = document.createElement('span');
  words.textContent = text;
  const close = document.createElement('button');
  close.textContent = '×';
  close.setAttribute('aria-label', 'Close message');
  close.onclick = () => item.remove();
  item.append(words, close);
  list.append(item);
  while (list.children.length > 4) list.firstChild.remove();
  if (kind !== 'error') setTimeout(() => item.remove(), kShownMs);
}

export const close_notices = () => document.getElementById('notices').replaceChildren();
