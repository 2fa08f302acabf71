// Several results on one page, read as a fleet, as one arm over time, or as
// several methods to calibrate the same measurements.

function changesTable(comparison) {
  const labels = comparison.results.map((item) => item.label);
  const {changes, total} = comparison.time;
  const rows = changes.map((change) => {
    const {unit, significant} = change;
    return {
      className: significant ? 'outlier' : undefined,
      cells: [
        change.name, labels[change.from], labels[change.from + 1],
        fixedCell(inUnit(change.before, unit), 4),
        fixedCell(inUnit(change.after, unit), 4),
        cell(
            signed(fixed(inUnit(change.difference, unit), 4)),
            inUnit(change.difference, unit)),
        numberCell(inUnit(change.std, unit), 2), unitName(unit),
        cell(
            isNumber(change.score) ? signed(fixed(change.score, 1)) : '–',
            change.score),
        badge(
            significant ? 'warn' : 'plain',
            significant ? 'significant' : 'not significant')
      ]
    };
  });
  return table({
    id: 'changes',
    caption:
        'Changes from each result to the next, the most significant first' +
        (rows.length < total ? `, ${rows.length} of ${total}` : ''),
    columns: [
      {title: 'parameter'}, {title: 'from'}, {title: 'to'},
      {title: 'before', align: 'right'}, {title: 'after', align: 'right'},
      {title: 'change', align: 'right'},
      {title: 'std', align: 'right', help: 'of the change'}, {title: 'unit'},
      {title: 'change / std', align: 'right'}, {title: 'verdict'}
    ],
    rows
  });
}

function changesFigure(comparison) {
  const labels = comparison.results.map((item) => item.label);
  const {changes, threshold} = comparison.time;
  const markers = ['circle', 'square', 'triangle'];
  const judged = changes.filter((change) => isNumber(change.score));
  if (judged.length === 0) return null;
  const rows = [...new Set(judged.map((change) => change.name))].map((name) => {
    const mine = judged.filter((change) => change.name === name);
    return {
      label: name,
      marks: mine.map(
          (change) => ({
            at: change.score,
            marker: markers[change.from % 3],
            className: change.significant ? 'c1' : 'c2',
            tip: `${name}, ${labels[change.from]} to ` +
                `${labels[change.from + 1]}:\n` +
                `${signed(quantity(change.difference, change.unit))}, ` +
                `${fixed(change.score, 1)} std`
          })),
      emphasised: mine.some((change) => change.significant)
    };
  });
  return figure({
    id: 'changes-figure',
    title: 'Change of each parameter in units of its standard deviation',
    draw: (width) => rowPlot(width, {
      rows,
      x: {label: 'change / standard deviation', zero: true},
      legend: labels.length <= 4 &&
          labels.slice(1).map((label, i) => ({
                                label: `${labels[i]} to ${label}`,
                                className: 'c2',
                                marker: markers[i]
                              })),
      vlines: [{x: -threshold}, {x: 0}, {x: threshold}],
      description: 'Changes of parameters in standard deviations'
    }),
    note: `Beyond the dashed lines at ${threshold} a change is significant.`
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

const timeView = (comparison) =>
    [h('div', {class: 'pair'}, changesFigure(comparison),
       accuracyOverTime(comparison)),
     note(
         'Only parameters of the joints that are estimated in both results are ' +
         'compared; base and tool move with the instrument and the target.'),
     changesTable(comparison)];

// Several methods: every solver of every result.
function methodsTable(comparison) {
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
    id: 'methods',
    caption: 'Every method, side by side',
    columns: [
      {title: 'result'}, {title: 'solver'}, {title: 'outcome'},
      {title: 'free', align: 'right'}, {title: 'iterations', align: 'right'},
      {title: 'chi-square', align: 'right'},
      {title: 'training mean', unit: 'mm', align: 'right'},
      {title: 'validation mean', unit: 'mm', align: 'right'},
      {title: 'validation largest', unit: 'mm', align: 'right'},
      {title: 'solving', align: 'right'}
    ],
    rows
  });
}

function methodsView(comparison) {
  const rows = comparison.methods.ranking.slice(0, 60).map((place) => {
    const item = comparison.results[place];
    const {after} = judgedSet(item);
    return {
      label: item.label,
      marks: [{
        at: after.mean * 1e3,
        className: 'c2',
        lower: after.mean * 1e3,
        upper: after.max * 1e3,
        tip: `${item.label}: mean ${length(after.mean)}, largest ${
            length(after.max)}`
      }]
    };
  });
  return [
    figure({
      id: 'methods-figure',
      title: 'Error after calibration by each method, mean to largest',
      draw: (width) => rowPlot(width, {
        rows,
        x: {label: 'position error [mm]', log: true},
        description: 'Error after calibration by each method'
      })
    }),
    methodsTable(comparison)
  ];
}

const VIEWS = {
  fleet: {title: 'A fleet of arms', view: fleetView},
  time: {title: 'One arm over time', view: timeView},
  methods: {title: 'Methods on the same data', view: methodsView},
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
    const parts =
        comparison.results.length > 0 ? VIEWS[kind].view(comparison) : [];
    heading.textContent = VIEWS[kind].title;
    document.title = VIEWS[kind].title + ' – Alidade';
    for (const button of buttons) {
      button.setAttribute('aria-pressed', String(button.dataset.kind === kind));
    }
    body.replaceChildren(
        ...verdictNodes(comparison[kind].verdict),
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
