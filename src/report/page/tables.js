// Tables sort by any column and copy as CSV.

// What a cell is worth: the number in full, or its text.
const rawValue = (cell) =>
    (cell.dataset.value === undefined ? cell.textContent :
                                        Number(cell.dataset.value));

// Empty cells stay last either way.
function compareCells(a, b, sign) {
  const [x, y] = [rawValue(a), rawValue(b)];
  if (x === '' || y === '') return (x === '') - (y === '');
  if (typeof x === 'number' && typeof y === 'number') return sign * (x - y);
  return sign * String(x).localeCompare(String(y), 'en', {numeric: true});
}

// Sorted rows leave their groups.
function makeSortable(table) {
  const headers = all('thead th', table);
  const body = table.tBodies[0];
  const rows = all('tbody tr:not(.group)', table);
  headers.forEach((header, i) => {
    const sort = () => {
      const down = header.ariaSort === 'ascending';
      for (const other of headers) other.ariaSort = 'none';
      header.ariaSort = down ? 'descending' : 'ascending';
      body.replaceChildren(...rows.sort(
          (a, b) => compareCells(a.cells[i], b.cells[i], down ? -1 : 1)));
      for (const other of [...table.tBodies].slice(1)) other.remove();
    };
    const title = header.title || 'sort by ' + header.textContent;
    header.append(
        h('button', {type: 'button', title, onclick: sort},
          ...header.childNodes));
    header.ariaSort = 'none';
  });
}

const csvCell = (value) => {
  const text = String(value);
  return /[",\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text;
};

const tableCsv = (table) =>
    all('tr:not(.group)', table)
        .map(
            (row) => [...row.cells].map(rawValue).map(csvCell).join(',') + '\n')
        .join('');

for (const holder of all('.table')) {
  const table = holder.querySelector('table');
  const caption = holder.querySelector('h3')?.textContent ?? 'without a title';
  const said = h('span', {role: 'status', class: 'said'});
  const copy = async () => {
    await copyText(tableCsv(table));
    said.textContent = 'copied';
    setTimeout(() => said.replaceChildren(), 2000);
  };
  makeSortable(table);
  addTools(
      holder, said,
      tool('Copy CSV', `Copy CSV of the table "${caption}"`, copy));
}
