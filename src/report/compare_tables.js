// Sorts a table by the column whose head is clicked. Rows without a number in that column come last.
(() => {
'use strict';

// Returns the number of a cell such as "1,234", "12.3 KB" or "3/5", or its text where it has no number.
const kUnits = {B: 1, KB: 1e3, MB: 1e6, GB: 1e9};
const valueOf = (row, column) => {
  const cell = row.cells[column];
  if (!cell || cell.colSpan > 1) return '';  // the reason of a failure, which spans the other columns
  const text = cell.textContent.trim();
  const number = parseFloat(text.replace(/,/g, ''));
  if (text === '=') return Infinity;  // no error at all
  return Number.isNaN(number) ? text : number * (kUnits[text.split(' ')[1]] ?? 1);
};

const compare = (a, b) => {
  if (typeof a !== typeof b) return typeof a === 'number' ? -1 : 1;
  return typeof a === 'number' ? a - b : a.localeCompare(b);
};

const sortBy = (table, head) => {
  const falling = head.ariaSort === 'ascending';
  for (const other of table.tHead.rows[0].cells) other.ariaSort = null;
  head.ariaSort = falling ? 'descending' : 'ascending';
  const [body] = table.tBodies;
  const keyed = [...body.rows].map((row) => [valueOf(row, head.cellIndex), row]);
  const isNumber = ([value]) => typeof value === 'number';
  keyed.sort(([a], [b]) => compare(a, b));
  if (falling) keyed.reverse();
  // Numbers come before text in both directions.
  body.append(...[...keyed.filter(isNumber), ...keyed.filter((one) => !isNumber(one))].map(([, row]) => row));
};

for (const table of document.querySelectorAll('table')) {
  for (const head of table.tHead.rows[0].cells) {
    if (head.querySelector('a')) {
      // The link stays a link; the rest of its cell sorts.
      head.addEventListener('click', (event) => { if (!event.target.closest('a')) sortBy(table, head); });
      head.style.cursor = 'pointer';
      continue;
    }
    const button = document.createElement('button');
    button.type = 'button';
    button.title = 'sort';
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener('click', () => sortBy(table, head));
  }
}
})();
