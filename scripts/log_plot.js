// Draws plots of measurements on logarithmic axes, side by side, as one SVG.
'use strict';

const panel = {width: 330, height: 250, left: 52, top: 34, gap: 60};

// From a power of ten to a little more than the largest.
function logarithmicRange(values) {
  return [10 ** Math.floor(Math.log10(1.01 * Math.min(...values))), 1.3 * Math.max(...values)];
}

// Powers of ten within a range.
function decades(from, to) {
  const values = [];
  for (let value = from; value <= to; value *= 10) values.push(value);
  return values;
}

// One log-log panel: lines {name, color, points: [[x, y]]}. `ticks`: of the horizontal axis, from its begin to its end;
// default: powers of ten. `legend`: the side of the names.
function plotPanel(column, {title, lines, ticks, legend = 'right'}) {
  const [x0, x1] = ticks ? [ticks[0], ticks[ticks.length - 1]]
                         : logarithmicRange(lines.flatMap((line) => line.points.map(([x]) => x)));
  const [y0, y1] = logarithmicRange(lines.flatMap((line) => line.points.map(([, y]) => y)));
  const left = panel.left + column * (panel.width + panel.gap);
  const x = (value) => left + panel.width * Math.log10(value / x0) / Math.log10(x1 / x0);
  const y = (value) => panel.top + panel.height * (1 - Math.log10(value / y0) / Math.log10(y1 / y0));
  const parts = [`<text x="${left}" y="20" font-weight="bold">${title}</text>`];
  for (const value of ticks || decades(x0, x1)) {
    parts.push(`<path d="M${x(value).toFixed(1)} ${panel.top}v${panel.height}" stroke="#ddd"/>`,
               `<text x="${x(value).toFixed(1)}" y="${panel.top + panel.height + 18}" text-anchor="middle">${
                 value.toLocaleString('en')}</text>`);
  }
  for (const value of decades(y0, y1)) {
    parts.push(`<path d="M${left} ${y(value).toFixed(1)}h${panel.width}" stroke="#ddd"/>`,
               `<text x="${left - 6}" y="${(y(value) + 4).toFixed(1)}" text-anchor="end">${
                 Number(value.toPrecision(1))}</text>`);
  }
  lines.forEach(({name, color, points}, i) => {
    const coordinates = points.map(([px, py]) => `${x(px).toFixed(1)},${y(py).toFixed(1)}`);
    parts.push(`<polyline points="${coordinates.join(' ')}" fill="none" stroke="${color}" stroke-width="2"/>`);
    for (const at of coordinates) {
      const [cx, cy] = at.split(',');
      parts.push(`<circle cx="${cx}" cy="${cy}" r="3" fill="${color}"/>`);
    }
    const line = panel.top + panel.height - 10 - 16 * (lines.length - 1 - i);
    const [side, anchor] = legend === 'right' ? [left + panel.width - 10, 'end'] : [left + 10, 'start'];
    parts.push(`<text x="${side}" y="${line}" text-anchor="${anchor}" fill="${color}">${name}</text>`);
  });
  return parts.join('\n');
}

// panels: [{title, unit, lines, ticks, legend}]; `unit` is what the horizontal axis counts.
function plotPanels(panels) {
  const width = panel.left + panels.length * panel.width + (panels.length - 1) * panel.gap + 40;
  const height = panel.top + panel.height + 50;
  const units = panels.map(({unit}, column) => {
    const middle = panel.left + column * (panel.width + panel.gap) + panel.width / 2;
    return `<text x="${middle}" y="${height - 10}" text-anchor="middle">${unit}</text>`;
  });
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" ` +
         `font-family="system-ui, sans-serif" font-size="12">\n<rect width="100%" height="100%" fill="#fff"/>\n` +
         `${panels.map((one, column) => plotPanel(column, one)).join('\n')}\n${units.join('\n')}\n</svg>\n`;
}

module.exports = {plotPanels};
