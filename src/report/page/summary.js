// The first screen of a result: what was wrong, what is right now, and whether
// it may be believed.

// The poses that the arm is judged by: validation poses where there are any.
function judged(result) {
  const accuracy = result.accuracy;
  return accuracy.heldout && accuracy.heldout.after.n > 0 ? accuracy.heldout :
                                                            accuracy.train;
}

function firstScreen(entry) {
  const result = entry.result;
  const numbers = h(
      'div', {}, h('div', {class: 'numbers', id: 'headline'}, headline(result)),
      accuracyTable(result, 'm'), accuracyTable(result, 'rad'),
      acceptanceList(result), findingText(result, /^measurement_noise$/),
      result.accuracy.before_note &&
          note(
              'Before: ' +
              result.accuracy.before_note.replace(/^before: /, '') + '.'));
  const view = armView(entry);
  return h(
      'section', {id: 'summary', 'aria-label': 'Summary'},
      verdictNodes(result.verdict),
      view ? h('div', {class: 'first'}, numbers, view) : numbers,
      warningBox(result));
}

// Mean and largest, before and after, of what is judged.
function headline(result) {
  const set = judged(result);
  const pair = (title, before, after, show) =>
      h('div', {}, h('div', {class: 'small'}, title),
        h('div', {class: 'big'}, h('span', {class: 'then'}, show(before)),
          ' → ', h('span', {class: 'now'}, show(after))),
        after > 0 && before > 0 &&
            h('div', {class: 'small'}, timesText(before / after)));
  const items = [];
  if (set.after.n > 0) {
    items.push(
        pair('mean position error', set.before.mean, set.after.mean, length),
        pair('largest', set.before.max, set.after.max, length));
  }
  if (set.rotation_after) {
    items.push(pair(
        'mean orientation error', set.rotation_before.mean,
        set.rotation_after.mean, angle));
  }
  return items;
}

const timesText = (ratio) =>
    (ratio >= 1 ? num(ratio, 2) + ' times smaller' :
                  num(1 / ratio, 2) + ' times larger');

// One row a set and calibration; positions and orientations apart.
function accuracyTable(result, unit) {
  const prefix = isAngle(unit) ? 'rotation_' : '';
  const rows = [];
  const add = (title, accuracy) => {
    if (!accuracy || accuracy.n === 0) return;
    rows.push({
      cells: [
        title, ...['mean', 'rms', 'p95', 'max'].map((key) => {
          const value = inUnit(accuracy[key], unit);
          return numberCell(value, value < 1e-3 ? 2 : 3);
        }),
        cell(grouped(accuracy.n), accuracy.n)
      ]
    });
  };
  for (const [title, set] of [
           ['validation', result.accuracy.heldout],
           ['training', result.accuracy.train]]) {
    if (!set) continue;
    add(title + ', before', set[prefix + 'before']);
    add(title + ', after', set[prefix + 'after']);
  }
  const folds = result.cross_validation;
  if (folds) {
    add(`${folds.folds} folds, after`,
        isAngle(unit) ? folds.rotation : folds.position);
  }
  if (rows.length === 0) return null;
  return table({
    id: isAngle(unit) ? 'rotation-accuracy' : 'accuracy',
    caption: isAngle(unit) ? 'Orientation error [°]' : 'Position error [mm]',
    columns: [
      {title: 'poses'}, {title: 'mean', align: 'right'},
      {title: 'RMS', align: 'right'},
      {title: '95 %', align: 'right', help: '95 of 100 are below'},
      {title: 'largest', align: 'right'}, {title: 'n', align: 'right'}
    ],
    rows
  });
}

function acceptanceList(result) {
  const checks = findingsOf(result, /^acceptance\./);
  if (checks.length === 0) return findingText(result, /^acceptance$/);
  return h(
      'ul', {id: 'acceptance', class: 'plain'},
      checks.map(
          ({level, sentence}) =>
              h('li', {},
                badge(LEVELS[level], level === 'passed' ? 'met' : 'missed'),
                ' ', typeset(sentence))));
}

function warningBox(result) {
  const warnings = findingsOf(result, /^(warning$|plausibility\.)/);
  if (warnings.length === 0) return null;
  return h(
      'div', {class: 'warnings', id: 'warnings'},
      h('strong', {},
        warnings.length === 1 ?
            'Before you rely on it' :
            `Before you rely on it: ${warnings.length} warnings`),
      h('ul', {},
        warnings.map(({sentence}) => h('li', {}, typeset(sentence)))));
}
