// The viewer of two images: swipe, flip and difference, zoom and pan of both together, and the colours under the
// pointer. Without this script, and where it fails, the page shows every image beside its difference.
(() => {
'use strict';

const kLargestZoom = 64;    // screen pixels per image pixel
const kNearestFrom = 2;     // pixels have sharp edges from this zoom on,
const kNearestFitFrom = 4;  // or from this zoom on where the whole image fits
const kZoomStep = 1.25;
const kDoubleClickZoom = 8;
const kVisible = 1;         // larger differences, in steps of 1/255, are counted

const clamp = (value, least, most) => Math.min(Math.max(value, least), most);

const canvasOf = (width, height) => {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  return canvas;
};

const pixelsOf = (image) => {
  const context = canvasOf(image.naturalWidth, image.naturalHeight).getContext('2d', {willReadFrequently: true});
  context.drawImage(image, 0, 0);
  return context.getImageData(0, 0, image.naturalWidth, image.naturalHeight).data;
};

const elementOf = (name, text) => {
  const element = document.createElement(name);
  element.textContent = text;
  return element;
};

// Returns the value that a colour of a heat map stands for: 0 for white, otherwise that of the nearest colour of
// its scale.
const valueOf = (legend, red, green, blue) => {
  if (red + green + blue === 3 * 255) return 0;
  const most = Number(legend.dataset.most);
  const ramp = legend.dataset.ramp.split(' ').map((color) => color.split(',').map(Number));
  const steps = Math.max(100, Number.isInteger(most) ? Math.min(most, 10000) : 0);
  let best = 0;
  let least = Infinity;
  for (let step = 0; step <= steps; ++step) {
    const place = step / steps * (ramp.length - 1);
    const low = Math.min(Math.floor(place), ramp.length - 2);
    const mixed = ramp[low].map((a, c) => a + (place - low) * (ramp[low + 1][c] - a));
    const distance = Math.hypot(mixed[0] - red, mixed[1] - green, mixed[2] - blue);
    if (distance < least) [least, best] = [distance, step / steps * most];
  }
  return Number.isInteger(most) ? Math.max(1, Math.round(best)) : Number(best.toPrecision(2));
};

class Viewer {
  constructor(root) {
    this.root = root;
    this.section = root.closest('section');
    const find = (name) => root.querySelector(name);
    this.stage = find('.stage');
    this.canvas = find('canvas');
    this.divider = find('.divider');
    this.menus = [find('select.left'), find('select.right')];
    this.tags = [find('.tag.left'), find('.tag.right')];
    this.gain = find('select.gain');
    this.zoomText = find('output');
    this.readout = find('.readout');
    this.legends = find('.legends');
    this.mode = 'swipe';
    this.split = 0.5;      // share of the stage's width at which the right image begins
    this.flipped = false;  // the right image is shown while it is held
    this.scale = 0;        // screen pixels per image pixel; 0: the whole image fits
    this.x = this.y = 0;   // of the image, at the stage's upper left corner
    this.pointers = new Map();
    this.bind();
  }

  start() {
    this.choose();
    this.root.hidden = false;
    this.section.querySelector('.flip').hidden = true;
    new ResizeObserver(() => this.draw()).observe(this.stage);
    this.draw();
  }

  // -------------------------------------------------------------------------------------------- what is shown

  // Takes the images that both menus name, and keeps their pixels as long as they are shown.
  choose() {
    const chosen = this.menus.map((menu) => menu.selectedOptions[0]);
    const images = chosen.map((option) => this.section.querySelector(`img[data-picture="${option.value}"]`));
    const figures = images.map((image) => image.closest('figure'));
    this.images = images;
    this.pixels = images.map(pixelsOf);
    this.names = chosen.map((option) => option.textContent);
    this.scales = figures.map((figure) => figure.querySelector('.legend'));  // of heat maps
    this.reading = false;
    this.legends.replaceChildren(...[...new Set(this.scales.filter(Boolean))]
        .map((legend) => legend.cloneNode(true)));
    this.tags.forEach((tag, side) => {
      tag.textContent = this.scales[side] ? figures[side].querySelector('figcaption').textContent :
                                            `${this.names[side]}: ${chosen[side].dataset.words}`;
    });
    this.subtract();
    this.draw();
  }

  // Makes the difference of both images, multiplied by the amplification of the menu.
  subtract() {
    const [left, right] = this.pixels;
    const {naturalWidth: width, naturalHeight: height} = this.images[0];
    const gain = Number(this.gain.value);
    const result = new ImageData(width, height);
    this.differing = 0;
    this.largest = 0;
    for (let i = 0; i < left.length; i += 4) {
      let most = 0;
      for (let c = i; c < i + 3; ++c) {
        const difference = Math.abs(left[c] - right[c]);
        most = Math.max(most, difference);
        result.data[c] = gain * difference;  // clamped by its type
      }
      result.data[i + 3] = 255;
      if (most > kVisible) ++this.differing;
      this.largest = Math.max(this.largest, most);
    }
    this.difference = canvasOf(width, height);
    this.difference.getContext('2d').putImageData(result, 0, 0);
  }

  get width() { return this.images[0].naturalWidth; }
  get height() { return this.images[0].naturalHeight; }
  get fit() { return Math.min(this.stage.clientWidth / this.width, this.stage.clientHeight / this.height); }
  get zoom() { return this.scale || this.fit; }

  draw() {
    const ratio = window.devicePixelRatio || 1;
    const {clientWidth: width, clientHeight: height} = this.stage;
    if (!this.images || width === 0) return;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.keepInside();
    const context = this.canvas.getContext('2d');
    context.scale(ratio, ratio);
    context.imageSmoothingEnabled = this.zoom * ratio < (this.scale ? kNearestFrom : kNearestFitFrom);
    if (this.mode === 'difference') this.paint(context, this.difference, 0, width);
    if (this.mode === 'flip') this.paint(context, this.images[this.flipped ? 1 : 0], 0, width);
    if (this.mode === 'swipe') {
      this.paint(context, this.images[0], 0, this.split * width);
      this.paint(context, this.images[1], this.split * width, width);
    }
    this.show();
  }

  // From `first` to `last` on the stage.
  paint(context, image, first, last) {
    context.save();
    context.beginPath();
    context.rect(first, 0, last - first, this.stage.clientHeight);
    context.clip();
    context.drawImage(image, -this.x * this.zoom, -this.y * this.zoom, this.width * this.zoom,
                      this.height * this.zoom);
    context.restore();
  }

  // Updates the controls and texts around the images.
  show() {
    const percent = Math.round(100 * this.split);
    this.stage.dataset.mode = this.mode;
    this.divider.hidden = this.mode !== 'swipe';
    this.divider.style.left = `${100 * this.split}%`;
    this.divider.setAttribute('aria-valuenow', percent);
    this.tags[0].hidden = this.mode === 'difference' || (this.mode === 'flip' && this.flipped);
    this.tags[1].hidden = this.mode === 'difference' || (this.mode === 'flip' && !this.flipped);
    this.gain.parentElement.hidden = this.mode !== 'difference';
    this.stage.style.touchAction = this.scale ? 'none' : 'pan-y';
    this.zoomText.textContent = `${Math.round(100 * this.zoom)} %`;
    if (!this.reading && this.scales.some(Boolean)) this.readout.textContent = '';
    else if (!this.reading) {
      this.readout.textContent = `${this.differing.toLocaleString('en')} of ` +
          `${(this.width * this.height).toLocaleString('en')} pixels differ by more than ${kVisible}/255, ` +
          `at most by ${this.largest}/255`;
    }
  }

  // --------------------------------------------------------------------------------------------- zoom and pan

  // Centres an image that is smaller than the stage; a larger one fills the stage.
  keepInside() {
    const inside = (start, shown, all) => shown >= all ? (all - shown) / 2 : clamp(start, 0, all - shown);
    this.x = inside(this.x, this.stage.clientWidth / this.zoom, this.width);
    this.y = inside(this.y, this.stage.clientHeight / this.zoom, this.height);
  }

  // Changes the zoom so that the point at (left, top) of the stage stays there.
  zoomTo(scale, left, top) {
    const next = clamp(scale, this.fit, kLargestZoom);
    this.x += left / this.zoom - left / next;
    this.y += top / this.zoom - top / next;
    this.scale = next > this.fit ? next : 0;
    this.draw();
  }

  zoomBy(factor) {
    this.zoomTo(factor * this.zoom, this.stage.clientWidth / 2, this.stage.clientHeight / 2);
  }

  pan(right, down) {
    this.x += right / this.zoom;
    this.y += down / this.zoom;
    this.draw();
  }

  moveDivider(split) {
    this.split = clamp(split, 0, 1);
    this.draw();
  }

  // ----------------------------------------------------------------------------------- colours under the pointer

  read(left, top) {
    const x = Math.floor(this.x + left / this.zoom);
    const y = Math.floor(this.y + top / this.zoom);
    this.reading = x >= 0 && y >= 0 && x < this.width && y < this.height;
    if (!this.reading) return this.show();
    const first = 4 * (y * this.width + x);
    const colors = this.pixels.map((pixels) => [...pixels.slice(first, first + 3)]);
    const parts = [elementOf('span', `(${x}, ${y})`)];
    colors.forEach((color, side) => {
      const patch = elementOf('i', '');
      patch.style.background = `rgb(${color.join(' ')})`;
      const legend = this.scales[side];
      const value = legend ? `${valueOf(legend, ...color)} ${legend.dataset.unit}` : color.join(' ');
      parts.push(patch, elementOf('span', `${this.names[side]} ${value}`));
    });
    if (!this.scales.some(Boolean)) {
      const difference = colors[0].map((value, c) => Math.abs(value - colors[1][c]));
      parts.push(elementOf('span', `difference ${difference.join(' ')} of 255`));
    }
    this.readout.replaceChildren(...parts);
  }

  // ---------------------------------------------------------------------------------------------------- events

  bind() {
    for (const menu of this.menus) menu.addEventListener('change', () => this.choose());
    this.gain.addEventListener('change', () => { this.subtract(); this.draw(); });
    this.root.querySelector('.modes').addEventListener('change', (event) => {
      this.mode = event.target.value;
      this.flipped = false;
      this.draw();
    });
    this.root.querySelector('.swap').addEventListener('click', () => {
      const [left, right] = this.menus;
      [left.selectedIndex, right.selectedIndex] = [right.selectedIndex, left.selectedIndex];
      this.choose();
    });
    this.root.querySelector('.zooms').addEventListener('click', (event) => {
      const factor = {in: kZoomStep * kZoomStep, out: 1 / kZoomStep / kZoomStep, fit: 0}[event.target.value];
      if (factor !== undefined) this.zoomBy(factor);
    });
    this.bindPointers();
    this.bindKeys();
  }

  // Returns the position of an event on the stage.
  place(event) {
    const box = this.stage.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  bindPointers() {
    const stage = this.stage;
    stage.addEventListener('pointerdown', (event) => this.press(event));
    stage.addEventListener('pointermove', (event) => this.drag(event));
    for (const name of ['pointerup', 'pointercancel']) stage.addEventListener(name, (event) => this.release(event));
    stage.addEventListener('pointerleave', () => { this.reading = false; this.show(); });
    stage.addEventListener('dblclick', (event) => {
      this.zoomTo(this.scale ? 0 : kDoubleClickZoom, ...this.place(event));
    });
    // A wheel that scrolls the page past the image must not zoom it.
    stage.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && !event.metaKey && !stage.contains(document.activeElement)) return;
      event.preventDefault();
      this.zoomTo(this.zoom * (event.deltaY < 0 ? kZoomStep : 1 / kZoomStep), ...this.place(event));
    }, {passive: false});
  }

  press(event) {
    if (event.button !== 0) return;
    this.stage.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, this.place(event));
    const onDivider = this.divider.contains(event.target);
    this.swiping = this.mode === 'swipe' && (onDivider || !this.scale) && this.pointers.size === 1;
    (onDivider ? this.divider : this.stage).focus({preventScroll: true});
    if (this.swiping) this.moveDivider(this.place(event)[0] / this.stage.clientWidth);
    this.flip(true);
  }

  drag(event) {
    const [x, y] = this.place(event);
    const last = this.pointers.get(event.pointerId);
    if (last && this.pointers.size === 2) this.pinch(event.pointerId, [x, y]);
    else if (last && this.swiping) this.moveDivider(x / this.stage.clientWidth);
    else if (last) this.pan(last[0] - x, last[1] - y);
    if (last) this.pointers.set(event.pointerId, [x, y]);
    this.read(x, y);
  }

  // Zooms as one of two fingers moves to `place`, by the ratio of their distances.
  pinch(moved, place) {
    const last = this.pointers.get(moved);
    const [, other] = [...this.pointers].find(([id]) => id !== moved);
    const apart = (a) => Math.max(1, Math.hypot(a[0] - other[0], a[1] - other[1]));
    this.zoomTo(this.zoom * apart(place) / apart(last), (place[0] + other[0]) / 2, (place[1] + other[1]) / 2);
  }

  release(event) {
    this.pointers.delete(event.pointerId);
    this.swiping = false;
    this.flip(false);
  }

  flip(held) {
    if (this.flipped === held || this.mode !== 'flip') return;
    this.flipped = held;
    this.draw();
  }

  bindKeys() {
    this.divider.addEventListener('keydown', (event) => {
      const step = event.shiftKey ? 0.1 : 0.01;
      const split = {ArrowLeft: this.split - step, ArrowDown: this.split - step, ArrowRight: this.split + step,
                     ArrowUp: this.split + step, Home: 0, End: 1}[event.key];
      if (split === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      this.moveDivider(split);
    });
    const kPan = 40;
    const actions = {
      '+': () => this.zoomBy(kZoomStep), '=': () => this.zoomBy(kZoomStep), '-': () => this.zoomBy(1 / kZoomStep),
      0: () => this.zoomBy(0), ' ': () => this.flip(true),
      ArrowLeft: () => this.pan(-kPan, 0), ArrowRight: () => this.pan(kPan, 0),
      ArrowUp: () => this.pan(0, -kPan), ArrowDown: () => this.pan(0, kPan)
    };
    this.stage.addEventListener('keydown', (event) => {
      const action = actions[event.key];
      // A key that would do nothing here scrolls the page.
      const acts = event.key.startsWith('Arrow') ? this.scale > 0 : event.key !== ' ' || this.mode === 'flip';
      if (!action || !acts || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      action();
    });
    this.stage.addEventListener('keyup', (event) => { if (event.key === ' ') this.flip(false); });
    this.stage.addEventListener('blur', () => this.flip(false));
  }
}

// The images are part of the page, and so are loaded with it.
window.addEventListener('load', () => {
  for (const root of document.querySelectorAll('.viewer')) {
    try {
      new Viewer(root).start();
    } catch (error) {
      console.error(error);
    }
  }
});
})();
