// Elements of HTML and SVG. Text only ever becomes a text node.

const SVG = 'http://www.w3.org/2000/svg';

// An element with attributes ("on..." are listeners) and children.
const h = (tag, attributes, ...children) =>
    fill(document.createElement(tag), attributes, children);

// The same, of SVG.
const s = (tag, attributes, ...children) =>
    fill(document.createElementNS(SVG, tag), attributes, children);

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) {
      element.addEventListener(name.slice(2), value);
    } else {
      element.setAttribute(name, value);
    }
  }
  element.append(...children.flat(Infinity));
  return element;
}

const all = (selector, root = document) => [...root.querySelectorAll(selector)];

const tool = (text, label, onclick) =>
    h('button', {type: 'button', class: 'tool', 'aria-label': label, onclick},
      text);

// A tool beside the heading of a table or a figure.
const addTools = (element, ...tools) =>
    element.querySelector('.table-head')
        .append(h('span', {class: 'tools'}, ...tools));

function saveFile(name, type, text) {
  const url = URL.createObjectURL(new Blob([text], {type}));
  const link = h('a', {href: url, download: name});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

// Older browsers and pages opened as files may have no clipboard of their own.
async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch (error) {
    const area = h('textarea', {class: 'offscreen'});
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand('copy');
    area.remove();
  }
}

const fileName = (text, ending) =>
    (text.toLowerCase().replace(/[^a-z0-9]+/g, '_').replace(/^_|_$/g, '') ||
     'alidade') +
    ending;

// The numbers of this result, as result.json has them.
const resultData = document.getElementById('alidade-data');
if (resultData) {
  document.getElementById('provenance')
      .append(
          h('p', {},
            tool(
                'Save the result as JSON', 'Save the result as JSON',
                () => saveFile(
                    fileName(document.title, '.json'), 'application/json',
                    resultData.textContent))));
}
