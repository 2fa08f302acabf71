// Elements, numbers for people, and little statistics. Text only ever becomes a
// text node, so that no name of an arm or of a file can become markup.

const data = JSON.parse(document.getElementById('alidade-data').textContent);
const SVG = 'http://www.w3.org/2000/svg';

// An element with attributes ("on..." are listeners) and children.
function h(tag, attributes, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

// The same, of SVG.
function s(tag, attributes, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes || {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith('on')) {
      element.addEventListener(name.slice(2), value);
    } else {
      element.setAttribute(name, value === true ? '' : value);
    }
  }
  for (const child of children.flat(Infinity)) {
    if (child === undefined || child === null || child === false) continue;
    element.append(child instanceof Node ? child : String(child));
  }
  return element;
}

const isNumber = (value) => typeof value === 'number' && isFinite(value);
const maxOf = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity);
const minOf = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
const sum = (values) => values.reduce((a, b) => a + b, 0);

function median(values) {
  const sorted = values.filter(isNumber).sort((a, b) => a - b);
  if (sorted.length === 0) return NaN;
  const middle = (sorted.length - 1) / 2;
  return (sorted[Math.floor(middle)] + sorted[Math.ceil(middle)]) / 2;
}

const MINUS = '\u2212';
const superscript = (text) => text.replace(
    /./g,
    (c) => ({
             '-': '⁻',
             '0': '⁰',
             '1': '¹',
             '2': '²',
             '3': '³',
             '4': '⁴',
             '5': '⁵',
             '6': '⁶',
             '7': '⁷',
             '8': '⁸',
             '9': '⁹'
           })[c] ||
        c);

// "0.0123", "2.3×10⁻¹³": significant digits, no longer than they mean.
function num(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (!isFinite(value)) return value > 0 ? '∞' : MINUS + '∞';
  if (value === 0) return '0';
  const magnitude = Math.abs(value);
  let text;
  if (magnitude < 1e-3 || magnitude >= 1e6) {
    const [mantissa, exponent] = magnitude.toExponential(digits - 1).split('e');
    text = mantissa + '×10' + superscript(exponent.replace('+', ''));
  } else {
    const decimals = digits - 1 - Math.floor(Math.log10(magnitude));
    text = decimals < 0 ? String(Number(magnitude.toPrecision(digits))) :
                          magnitude.toFixed(Math.min(decimals, 20));
  }
  return (value < 0 ? MINUS : '') + text;
}

// A sentence with its "-2.3e-13" as figures have such numbers.
const typeset = (sentence) => sentence
                                  .replace(
                                      /(\d)e([-+]\d+)\b/g,
                                      (all, digit, exponent) => digit + '×10' +
                                          superscript(String(Number(exponent))))
                                  .replace(/(\s|\()-(?=\d)/g, '$1' + MINUS);

const percent = (share) => Number((100 * share).toPrecision(3)) + '\u00a0%';

// Fixed decimals, for columns that are compared down the page.
function fixed(value, decimals) {
  if (!isNumber(value)) return num(value);
  const text = Math.abs(value).toFixed(decimals);
  return (value < 0 && Number(text) !== 0 ? MINUS : '') + text;
}

const signed = (text) =>
    (/^[−–0]/.test(text) && !/^0\.|^0×/.test(text) ? text : '+' + text);
const grouped = (count) => String(count).replace(/\B(?=(\d{3})+$)/g, '\u202f');
const count = (number, singular) =>
    grouped(number) + ' ' + singular + (number === 1 ? '' : 's');
const ofAll = (some, all, singular) =>
    (some === all ? 'all ' + count(all, singular) :
                    grouped(some) + ' of ' + count(all, singular));

// Results are in SI; people read mm and degrees.
const isAngle = (unit) => unit === 'rad';
const unitName = (unit) => (isAngle(unit) ? '°' : 'mm');
const inUnit = (value, unit) =>
    (isAngle(unit) ? value * 180 / Math.PI : value * 1e3);
const length = (metres, digits = 3) => num(metres * 1e3, digits) + '\u00a0mm';
const angle = (radians, digits = 3) =>
    num(radians * 180 / Math.PI, digits) + '°';
const quantity = (value, unit, digits = 3) =>
    (isAngle(unit) ? angle(value, digits) : length(value, digits));

function duration(seconds) {
  if (!isNumber(seconds)) return '–';
  if (seconds < 1e-3) return num(seconds * 1e6) + ' µs';
  if (seconds < 1) return num(seconds * 1e3) + ' ms';
  if (seconds < 120) return num(seconds) + ' s';
  return num(seconds / 60) + ' min';
}

const solverTitle = (name) => ({
                                ceres: 'Levenberg-Marquardt',
                                pseudo_inverse: 'iterated pseudo-inverse',
                              })[name] ||
    name;

const shortSolverTitle = (name) =>
    ({ceres: 'Levenberg-Marquardt', pseudo_inverse: 'pseudo-inverse'})[name] ||
    name;

const statusTitle = (status) =>
    ({
      not_run: 'not run',
      converged: 'converged',
      rounding_floor: 'stopped at the numerical precision limit',
      iteration_limit: 'stopped at the iteration limit',
      failed: 'failed',
      unusable: 'unusable',
    })[status] ||
    status;

// A section with its heading; nothing where it has no content.
function section(id, title, ...children) {
  const content = children.flat(Infinity).filter(Boolean);
  if (content.length === 0) return null;
  return h(
      'section', {id, 'aria-labelledby': id + '-title'},
      h('h2', {id: id + '-title'}, title), content);
}

const p = (...children) => h('p', {}, ...children);
const note = (...children) => h('p', {class: 'note'}, ...children);

// A mark that is told by its sign and its words, never by colour alone.
const badge = (kind, text) =>
    h('span', {class: 'badge ' + kind},
      h('span', {'aria-hidden': 'true'},
        {good: '✓', bad: '✗', warn: '!', plain: '·'}[kind] || '', ' '),
      text);

// What was decided of a result: {level, title, sentence}, and its findings.
const LEVELS = {
  passed: 'good',
  note: 'plain',
  attention: 'warn',
  failed: 'bad'
};

const verdictNodes = ({level, title, sentence}) =>
    [p(badge(LEVELS[level], title)),
     h('p', {class: 'verdict', id: 'verdict'}, typeset(sentence))];

const findingsOf = (result, pattern) =>
    result.verdict.findings.filter((finding) => pattern.test(finding.key));

// The sentences of findings as a paragraph, nothing where there are none.
function findingText(result, pattern) {
  const found = findingsOf(result, pattern);
  return found.length > 0 &&
      p(typeset(found.map(({sentence}) => sentence).join(' ')));
}

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
