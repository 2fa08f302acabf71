// Tables that sort by any column and copy as CSV.

// A cell: its text, and the value that it sorts and copies by.
const cell = (text, value) => ({text, value});
const numberCell = (value, digits) => cell(num(value, digits), value);
const fixedCell = (value, decimals) => cell(fixed(value, decimals), value);

const csvCell = (value) => {
  const text = value === null || value === undefined ? '' : String(value);
  return /[",\n]/.test(text) ? '"' + text.replace(/"/g, '""') + '"' : text;
};

// What a cell is worth outside of the page: the number in full, or its text.
const rawValue = (item) => {
  if (item === null || item === undefined) return '';
  if (typeof item !== 'object') return item;
  if (item.value !== undefined) return isEmpty(item.value) ? '' : item.value;
  return item instanceof Node ? item.textContent : item.text;
};
const isEmpty = (value) => value === null || Number.isNaN(value);

function compareCells(a, b) {
  const x = rawValue(a), y = rawValue(b);
  if (x === '' || y === '') return (x === '') - (y === '');
  if (typeof x === 'number' && typeof y === 'number') return x - y;
  return String(x).localeCompare(String(y), 'en', {numeric: true});
}

// {id, caption, columns: [{title, unit, align, csv}], rows: [{cells,
// className}]} Cells are text, numbers, nodes or made by `cell`. `csv` names
// the column in CSV where its title is not enough.
function table(spec) {
  const body = h('tbody', {});
  const buttons = [];
  let rows = spec.rows;
  const show = () => body.replaceChildren(...rows.map(
      (row) =>
          h('tr', {class: row.className},
            row.cells.map((item, i) => tableCell(item, spec.columns[i], i)))));
  const sortBy = (index) => {
    const header = buttons[index].parentElement;
    const down = header.getAttribute('aria-sort') === 'ascending';
    buttons.forEach(
        (button) => button.parentElement.setAttribute('aria-sort', 'none'));
    header.setAttribute('aria-sort', down ? 'descending' : 'ascending');
    rows = [...spec.rows].sort((a, b) => {
      // Empty cells stay last either way.
      const x = rawValue(a.cells[index]), y = rawValue(b.cells[index]);
      const order = compareCells(a.cells[index], b.cells[index]);
      return x === '' || y === '' ? order : down ? -order : order;
    });
    show();
  };
  const head = h('tr', {}, spec.columns.map((column, i) => {
    const button =
        h('button', {
          type: 'button',
          onclick: () => sortBy(i),
          title: column.help || 'sort by ' + column.title
        },
          column.title,
          column.unit && h('span', {class: 'unit'}, ' [' + column.unit + ']'));
    buttons.push(button);
    return h(
        'th', {scope: 'col', class: column.align, 'aria-sort': 'none'}, button);
  }));
  show();
  return h(
      'div', {class: 'table'},
      h('div', {class: 'table-head'},
        h('h3', {id: spec.id + '-caption'}, spec.caption),
        copyButton(spec, () => rows)),
      h('div', {
        class: 'scroll',
        tabindex: '0',
        role: 'region',
        'aria-labelledby': spec.id + '-caption'
      },
        h('table', {id: spec.id, 'aria-labelledby': spec.id + '-caption'},
          h('thead', {}, head), body)));
}

function tableCell(item, column, index) {
  const content = item instanceof Node          ? item :
      item !== null && typeof item === 'object' ? item.text :
                                                  item;
  const value = item !== null && typeof item === 'object' &&
          typeof item.value === 'number' ?
      item.value :
      undefined;
  return h(
      index === 0 ? 'th' : 'td',
      {class: column.align, scope: index === 0 && 'row', 'data-value': value},
      content);
}

function tableCsv(spec, rows) {
  const header = spec.columns.map(
      (column) => csvCell(
          column.csv ||
          column.title +
              (column.unit ? ' [' + column.unit.replace('°', 'deg') + ']' :
                             '')));
  return [
    header,
    ...rows.map((row) => row.cells.map((item) => csvCell(rawValue(item))))
  ].map((line) => line.join(','))
             .join('\n') +
      '\n';
}

function copyButton(spec, rows) {
  const said = h('span', {role: 'status', class: 'said'});
  const copy = async () => {
    await copyText(tableCsv(spec, rows()));
    said.textContent = 'copied';
    setTimeout(() => {
      said.textContent = '';
    }, 2000);
  };
  return h(
      'span', {class: 'tools'}, said,
      h('button', {
        type: 'button',
        class: 'tool',
        onclick: copy,
        'aria-label': 'Copy the table "' + spec.caption + '" as CSV'
      },
        'Copy CSV'));
}
