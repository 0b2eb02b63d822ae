// ---------------------------------------------------------------- figures on a canvas

function readPalette() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(name).trim();
  return { colour, measured: colour('--measured'), font: getComputedStyle(document.body).fontFamily };
}

/** Clears a canvas that has the size of `onPage`, and sets it to the pixels of the screen. */
function prepareCanvas(canvas, onPage = canvas) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const [width, height] = [onPage.clientWidth, onPage.clientHeight];
  const [pixelWidth, pixelHeight] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== pixelWidth) canvas.width = pixelWidth;
  if (canvas.height !== pixelHeight) canvas.height = pixelHeight;
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, ratio };
}

function clipTo(context, box) {
  context.beginPath();
  context.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
  context.clip();
}

/** Buttons that move a view, each given by its label, its name and what it does. */
function toolbar(label, buttons) {
  const nodes = buttons.map(([sign, name, action]) => {
    const node = el('button', { type: 'button', 'aria-label': name, title: name }, sign);
    node.addEventListener('click', action);
    return node;
  });
  return el('div', { class: 'toolbar', role: 'group', 'aria-label': label }, ...nodes);
}
