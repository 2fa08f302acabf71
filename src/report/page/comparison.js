// Several results on one page, read as a fleet, as one arm over time, or as
// several ways to calibrate the same measurements.

// One arm over time: which parameters moved from each result to the next.
const MOVED = 3;
const MOST_MOVES = 500;  // in the table

// {name, unit, values, stds, free} by result, of the joints. Base and tool move
// with the instrument and the target, which says nothing of the arm.
function jointSeries(comparison) {
  const series = new Map();
  comparison.results.forEach((item, i) => {
    const layout = comparison.layouts[item.layout];
    layout.names.forEach((name, k) => {
      if (!JOINT_KINDS.includes(layout.kinds[k])) return;
      if (!series.has(name)) {
        const empty = () => Array(comparison.results.length).fill(NaN);
        series.set(name, {
          name,
          unit: layout.units[k],
          values: empty(),
          stds: empty(),
          free: []
        });
      }
      const mine = series.get(name);
      mine.values[i] = layout.nominal[k] + item.deviation[k];
      mine.stds[i] = isNumber(item.std[k]) ? item.std[k] : NaN;
      mine.free[i] = item.states[k] === 'f';
    });
  });
  return [...series.values()];
}

// Moves between results i and i + 1, in combined standard deviations.
function movesBetween(series, i) {
  return series.filter((one) => one.free[i] && one.free[i + 1]).map((one) => {
    const change = one.values[i + 1] - one.values[i];
    const std = Math.hypot(one.stds[i], one.stds[i + 1]);
    return {one, change, std, sigmas: change / std};
  });
}

function timeVerdict(comparison, moves) {
  const labels = comparison.results.map((item) => item.label);
  const found = moves.flatMap(
      (list, i) => list.filter((move) => Math.abs(move.sigmas) > MOVED)
                       .map((move) => ({...move, i})));
  const compared =
      moves.some((list) => list.some((move) => isNumber(move.sigmas)));
  if (!compared) {
    return {
      kind: 'warn',
      word: 'Cannot be told',
      sentence:
          'No parameter is known with its standard deviation in two results, so ' +
          'that nothing can be said of what moved.'
    };
  }
  if (found.length === 0) {
    return {
      kind: 'good',
      word: 'Nothing moved',
      sentence: 'No joint parameter ' +
          `moved by more than ${MOVED} standard deviations from ${
                    labels[0]} to ` +
          `${labels[labels.length - 1]}.`
    };
  }
  found.sort((a, b) => Math.abs(b.sigmas) - Math.abs(a.sigmas));
  const told = found.slice(0, 3).map(
      (move) => `${move.one.name} by ` +
          `${signed(quantity(move.change, move.one.unit))} (${
                    num(Math.abs(move.sigmas), 2)} ` +
          `standard deviations) to ${labels[move.i + 1]}`);
  return {
    kind: 'warn',
    word: found.length === 1 ? 'One parameter moved' : 'Parameters moved',
    sentence:
        (found.length === 1 ?
             'One joint parameter moved: ' :
             `${found.length} moves of joint parameters are more than chance, ` +
                 'the largest: ') +
        told.join('; ') + '.'
  };
}

function movesTable(comparison, moves) {
  const labels = comparison.results.map((item) => item.label);
  const rows =
      moves
          .flatMap((list, i) => list.map((move) => {
            const moved = Math.abs(move.sigmas) > MOVED;
            return {
              className: moved ? 'odd' : undefined,
              size: Math.abs(move.sigmas),
              cells: [
                move.one.name, labels[i], labels[i + 1],
                fixedCell(inUnit(move.one.values[i], move.one.unit), 4),
                fixedCell(inUnit(move.one.values[i + 1], move.one.unit), 4),
                cell(
                    signed(fixed(inUnit(move.change, move.one.unit), 4)),
                    inUnit(move.change, move.one.unit)),
                numberCell(inUnit(move.std, move.one.unit), 2),
                unitName(move.one.unit),
                cell(
                    isNumber(move.sigmas) ? signed(fixed(move.sigmas, 1)) : '–',
                    move.sigmas),
                badge(moved ? 'warn' : 'plain', moved ? 'moved' : 'as before')
              ]
            };
          }))
          .sort((a, b) => (b.size || 0) - (a.size || 0))
          .slice(0, MOST_MOVES);
  return table({
    id: 'moves',
    caption: 'Changes from each result to the next, the surest first' +
        (rows.length === MOST_MOVES ? `, ${MOST_MOVES} of them` : ''),
    columns: [
      {title: 'parameter'}, {title: 'from'}, {title: 'to'},
      {title: 'was', align: 'right'}, {title: 'is', align: 'right'},
      {title: 'change', align: 'right'},
      {title: 'std', align: 'right', help: 'of the change'}, {title: 'unit'},
      {title: 'change / std', align: 'right'}, {title: 'verdict'}
    ],
    rows
  });
}

function movesFigure(comparison, moves) {
  const labels = comparison.results.map((item) => item.label);
  const names = [...new Set(moves.flat().map((move) => move.one.name))];
  const rows = names.map((name) => {
    const marks = moves.flatMap(
        (list, i) =>
            list.filter(
                    (move) => move.one.name === name && isNumber(move.sigmas))
                .map((move) => ({
                       at: move.sigmas,
                       marker: ['circle', 'square', 'triangle'][i % 3],
                       className: Math.abs(move.sigmas) > MOVED ? 'c1' : 'c2',
                       tip: `${name}, ${labels[i]} to ${labels[i + 1]}:\n` +
                           `${signed(quantity(move.change, move.one.unit))}, ${
                                fixed(move.sigmas, 1)} std`
                     })));
    return {
      label: name,
      marks,
      emphasised: marks.some((mark) => Math.abs(mark.at) > MOVED)
    };
  });
  if (rows.length === 0) return null;
  return figure({
    id: 'moves-figure',
    title: 'Change of each parameter in units of ' +
        'its standard deviation',
    draw: (width) => rowPlot(width, {
      rows,
      x: {label: 'change / standard deviation', zero: true},
      vlines: [{x: -MOVED}, {x: 0}, {x: MOVED}],
      description: 'Changes of parameters in standard deviations'
    }),
    note: `Beyond the dashed lines at ${MOVED} a change is more than chance.`
  });
}

function accuracyOverTime(comparison) {
  const {results} = comparison;
  const x = results.map((item, i) => i + 1);
  const layer = (which, className, marker) => ({
    type: 'line',
    className,
    marker,
    label: which,
    x,
    y: results.map((item) => judgedSet(item)[which].mean * 1e3),
    tip: (i) => `${results[i].label}\n${which}: ${
        length(judgedSet(results[i])[which].mean)}`
  });
  return figure({
    id: 'accuracy-over-time',
    title: 'Mean position error',
    draw: (width) => plot(width, {
      x: {
        label: 'result, in order',
        integer: true,
        min: 0.5,
        max: results.length + 0.5
      },
      y: {label: 'mean error [mm]', log: true},
      layers: [layer('before', 'c1', 'square'), layer('after', 'c2', 'circle')],
      description: 'Mean error before and after, result by result'
    })
  });
}

function timeView(comparison) {
  const series = jointSeries(comparison);
  const moves =
      comparison.results.slice(1).map((item, i) => movesBetween(series, i));
  return {
    verdict: timeVerdict(comparison, moves),
    parts: [
      h('div', {class: 'pair'}, movesFigure(comparison, moves),
        accuracyOverTime(comparison)),
      note(
          'Only parameters of the joints that are free in both results are ' +
          'compared; base and tool move with the instrument and the target.'),
      movesTable(comparison, moves)
    ]
  };
}

// Several ways to calibrate: every solver of every result.
function waysTable(comparison) {
  const rows = comparison.results.flatMap(
      (item) => item.runs.map(
          (run, i) => ({
            cells: [
              labelNode(item), solverTitle(run.name), statusTitle(run.status),
              cell(String(item.num_free), item.num_free),
              cell(String(run.iterations), run.iterations),
              numberCell(run.cost, 4), numberCell(run.train.mean * 1e3),
              i === 0 && item.heldout ?
                  numberCell(item.heldout.after.mean * 1e3) :
                  cell('', null),
              i === 0 && item.heldout ?
                  numberCell(item.heldout.after.max * 1e3) :
                  cell('', null),
              cell(duration(run.time_s), run.time_s)
            ]
          })));
  return table({
    id: 'ways',
    caption: 'Every way, side by side',
    columns: [
      {title: 'result'}, {title: 'solver'}, {title: 'outcome'},
      {title: 'free', align: 'right'}, {title: 'iterations', align: 'right'},
      {title: 'chi-square', align: 'right'},
      {title: 'training mean', unit: 'mm', align: 'right'},
      {title: 'held-out mean', unit: 'mm', align: 'right'},
      {title: 'held-out largest', unit: 'mm', align: 'right'},
      {title: 'solving', align: 'right'}
    ],
    rows
  });
}

function waysView(comparison) {
  const {results} = comparison;
  const ranked = [...results].sort(
      (a, b) => judgedSet(a).after.mean - judgedSet(b).after.mean);
  const [best, worst] = [ranked[0], ranked[ranked.length - 1]];
  const seen = !results.every((item) => item.heldout);
  const verdict = {
    kind: 'good',
    word: count(results.length, 'way'),
    sentence: `${best.label} leaves the least: ${
                  length(judgedSet(best).after.mean)} in the mean at ` +
        `${seen ? 'training' : 'held-out'} poses; ${worst.label} the most: ` +
        `${length(judgedSet(worst).after.mean)}.`
  };
  const rows = ranked.slice(0, 60).map((item) => {
    const set = judgedSet(item);
    return {
      label: item.label,
      marks: [{
        at: set.after.mean * 1e3,
        className: 'c2',
        lower: set.after.mean * 1e3,
        upper: set.after.max * 1e3,
        tip: `${item.label}: mean ${length(set.after.mean)}, largest ${
            length(set.after.max)}`
      }]
    };
  });
  return {
    verdict,
    parts: [
      figure({
        id: 'ways-figure',
        title: 'Error that each way ' +
            'leaves, mean to largest',
        draw: (width) => rowPlot(width, {
          rows,
          x: {label: 'position error [mm]', log: true},
          description: 'Error after calibration of each way'
        })
      }),
      waysTable(comparison)
    ]
  };
}

const VIEWS = {
  fleet: {title: 'A fleet of arms', view: fleetView},
  time: {title: 'One arm over time', view: timeView},
  ways: {title: 'Ways to calibrate the same data', view: waysView},
};

function failureTable(failures) {
  if (failures.length === 0) return null;
  return table({
    id: 'failures',
    caption: `Failed (${failures.length})`,
    columns: [{title: 'job'}, {title: 'message', align: 'why'}],
    rows: failures.map((failure) => ({cells: [failure.label, failure.message]}))
  });
}

function comparisonPage(comparison) {
  const body = h('div', {});
  const heading = h('h1', {});
  const buttons = Object.keys(VIEWS).map(
      (kind) =>
          h('button',
            {type: 'button', 'data-kind': kind, onclick: () => show(kind)},
            VIEWS[kind].title));
  const show = (kind) => {
    const {verdict, parts} =
        comparison.results.length > 0 ? VIEWS[kind].view(comparison) : {
          verdict: {
            kind: 'bad',
            word: 'No result',
            sentence: 'Every calibration failed.'
          },
          parts: []
        };
    heading.textContent = VIEWS[kind].title;
    document.title = VIEWS[kind].title + ' – Alidade';
    for (const button of buttons) {
      button.setAttribute('aria-pressed', String(button.dataset.kind === kind));
    }
    body.replaceChildren(
        h('p', {}, badge(verdict.kind, verdict.word)),
        h('p', {class: 'verdict', id: 'verdict'}, verdict.sentence),
        ...parts.flat(Infinity).filter(Boolean));
  };
  show(comparison.kind);
  return [
    h('header', {}, heading,
      h('div', {
        class: 'controls',
        role: 'group',
        'aria-label': 'read these results as'
      },
        'Read as: ', buttons)),
    body, failureTable(comparison.failures),
    comparison.left_out > 0 &&
        note(`${
            count(
                comparison.left_out, 'further result')} are not on this page.`),
    h('p', {},
      h('button', {
        type: 'button',
        class: 'tool',
        onclick: () => saveFile(
            'comparison.json', 'application/json',
            JSON.stringify(data, null, 2))
      },
        'Save all data of this page as JSON')),
    footer(comparison.version)
  ].filter(Boolean);
}
