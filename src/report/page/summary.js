// The first screen of a result: what was wrong, what is right now, and whether
// it may be believed.

// The data set that speaks for the arm: poses that the fit has not seen where
// there are any.
function judged(result) {
  const accuracy = result.accuracy;
  return accuracy.heldout && accuracy.heldout.after.n > 0 ?
      {set: accuracy.heldout, seen: false} :
      {set: accuracy.train, seen: true};
}

// A mean error of more than this part of what it was is no gain.
const HARDLY_BETTER = 0.9;

const isUsable =
    (solver) => ['converged', 'rounding_floor', 'iteration_limit'].includes(
        solver.status);

// What the verdict rests on, and its sentence.
function verdictOf(result) {
  const {set, seen} = judged(result);
  const missed = result.acceptance.filter((check) => !check.met);
  const turned = set.after.n === 0 && set.rotation_after;
  const [before, after] = turned ? [set.rotation_before, set.rotation_after] :
                                   [set.before, set.after];
  const show = turned ? angle : length;
  if (!isUsable(result.solver)) {
    return {
      kind: 'bad',
      word: 'Not usable',
      sentence: `The solver ${
          statusTitle(result.solver.status)}: these values are not to be used.`
    };
  }
  const worse = after.mean > before.mean;
  const hardly = after.mean > HARDLY_BETTER * before.mean;
  const where = `at ${count(after.n, 'pose')} ` +
      (seen ? 'it was fitted to' : 'the fit has not seen');
  const sentence = worse ?
      `The calibration makes this arm worse: its mean error grows from ${
          show(before.mean)} to ${show(after.mean)} ${where}.` :
      `The arm was ${show(before.mean)} off and is now ${
          nowOff(result, after, show)}, in the mean ${where}.`;
  const limits = missed.length > 0 ? ' ' +
          (missed.length === 1 ? 'One acceptance limit is' :
                                 missed.length + ' acceptance limits are') +
          ' missed.' :
      result.acceptance.length > 0 ? ' All acceptance limits are met.' :
                                     '';
  const doubtful = result.warnings.length > 0;
  return {
    sentence: sentence + limits,
    seen,
    kind: worse || missed.length > 0 ? 'bad' :
        doubtful || hardly           ? 'warn' :
                                       'good',
    word: worse ? 'Worse than before' :
        missed.length > 0 ?
                  'Not accepted' :
                  (result.acceptance.length > 0 ? 'Accepted' : 'Usable') +
            (hardly       ? ', hardly better than before' :
                 doubtful ? ', with warnings' :
                            '')
  };
}

// Data without noise are met to rounding, which no other number tells.
const nowOff = (result, after, show) =>
    (after.max < 1e4 * result.solver.rounding_floor ?
         `exact to rounding (${show(after.mean, 1)})` :
         show(after.mean) + ' off');

// The mean length of noise in three coordinates of deviation 1: what a perfect
// arm would show.
const MEAN_OF_NOISE = Math.sqrt(8 / Math.PI);

// How much of the error that is left the instrument alone would show. A sigma
// that comes from the residuals says nothing of it, and one that they are far
// from is wrong.
function noiseNote(entry) {
  const {fit} = entry.result;
  const table = entry.tables && entry.tables.residuals;
  const arePositions = table && !table.columns.kind;
  if (!arePositions || !(fit.sigma > 0) || fit.estimated_sigma > 0) return null;
  const noise = MEAN_OF_NOISE * fit.sigma;
  const left = judged(entry.result).set.after.mean;
  if (noise < 0.1 * left || noise > 1.5 * left) return null;
  return note(
      `Measuring noise alone, of ${length(fit.sigma)} in each coordinate, ` +
      `would show ${length(noise)} in the mean: the arm itself is better ` +
      'than what is left says.');
}

function firstScreen(entry) {
  const result = entry.result;
  const verdict = verdictOf(result);
  const numbers = h(
      'div', {}, h('div', {class: 'numbers', id: 'headline'}, headline(result)),
      accuracyTable(result, 'm'), accuracyTable(result, 'rad'),
      acceptanceList(result, verdict), noiseNote(entry),
      result.accuracy.before_note &&
          note(
              'Before: ' +
              result.accuracy.before_note.replace(/^before: /, '') + '.'));
  const view = armView(entry);
  return h(
      'section', {id: 'summary', 'aria-label': 'Summary'},
      p(badge(verdict.kind, verdict.word)),
      h('p', {class: 'verdict', id: 'verdict'}, verdict.sentence),
      view ? h('div', {class: 'first'}, numbers, view) : numbers,
      warningBox(result));
}

// Mean and largest, before and after, of what is judged.
function headline(result) {
  const {set} = judged(result);
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
    (ratio >= 1e6      ? 'down to rounding error' :
         ratio >= 1.05 ? num(ratio, 2) + ' times smaller' :
         ratio > 0.95  ? 'unchanged' :
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
           ['held-out', result.accuracy.heldout],
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

function acceptanceList(result, verdict) {
  if (result.acceptance.length === 0) {
    return note(
        verdict.seen ?
            'No acceptance limits were set, and no poses were held out: these ' +
                'numbers do not tell how accurate the arm is elsewhere.' :
            'No acceptance limits were set.');
  }
  return h(
      'ul', {id: 'acceptance', class: 'plain'},
      result.acceptance.map(
          (check) =>
              h('li', {},
                badge(check.met ? 'good' : 'bad', check.met ? 'met' : 'missed'),
                ` ${quantityTitle(check.quantity)}: ` +
                    `${quantity(check.obtained, check.unit)}, limit ${
                        limitText(check)}`)));
}

// As the job states it, without the zeros that digits would add.
const limitText = ({limit, unit}) =>
    Number(inUnit(limit, unit).toPrecision(6)) +
    (isAngle(unit) ? '°' : '\u00a0mm');

function warningBox(result) {
  const warnings = [...new Set([
    ...result.warnings, ...result.identifiability.warnings,
    ...(result.uncertainty ? result.uncertainty.warnings || [] : [])
  ])];
  if (warnings.length === 0) return null;
  return h(
      'div', {class: 'warnings', id: 'warnings'},
      h('strong', {},
        warnings.length === 1 ?
            'Before you rely on it' :
            `Before you rely on it: ${warnings.length} warnings`),
      h('ul', {}, warnings.map((text) => h('li', {}, text))));
}
