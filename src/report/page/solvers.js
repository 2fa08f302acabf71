// How the solution was reached: iterations, stages, solvers side by side.

const SOLVER_LOOKS = [['c2', 'circle'], ['c1', 'square'], ['c4', 'triangle']];

function convergenceFigure(id, title, runs) {
  const shown = runs.filter((run) => run.history && run.history.length > 0);
  if (shown.length === 0) return null;
  const floor = runs[0].rounding_floor;
  return figure({
    id,
    title,
    draw: (width) => plot(width, {
      x: {label: 'iteration', integer: true, min: 0},
      y: {label: 'largest position error [mm]', log: true},
      layers: shown.map((run, i) => {
        const [className, marker] = SOLVER_LOOKS[i % SOLVER_LOOKS.length];
        const errors = run.history.map((record) => record.max_error * 1e3);
        return {
          type: 'line',
          className,
          label: solverTitle(run.name),
          marker: errors.length > 40 ? null : marker,
          x: run.history.map((record) => record.iteration),
          y: errors,
          tip: (k) => `${solverTitle(run.name)}, iteration ` +
              `${run.history[k].iteration}:\n${num(errors[k])} mm`
        };
      }),
      hlines: floor > 0 && maxOf(shown.map((run) => run.history.length)) > 0 &&
              minOf(shown.flatMap(
                  (run) => run.history.map((r) => r.max_error))) < 1e4 * floor ?
          [{y: floor * 1e3, label: 'numerical precision limit'}] :
          [],
      description: 'Largest position error by iteration of ' +
          shown.map((run) => solverTitle(run.name)).join(' and ')
    })
  });
}

function solverTable(runs) {
  const rows = [
    [
      'outcome', (run) => statusTitle(run.status).replace('stopped at the ', '')
    ],
    ['iterations', (run) => cell(String(run.iterations), run.iterations)],
    [
      'accepted steps',
      (run) => cell(String(run.accepted_steps), run.accepted_steps)
    ],
    [
      'rejected steps',
      (run) => cell(String(run.rejected_steps), run.rejected_steps)
    ],
    ['chi-square at the start', (run) => numberCell(run.initial_cost, 4)],
    ['chi-square at the end', (run) => numberCell(run.final_cost, 4)],
    ['RMS error, training [mm]', (run) => numberCell(run.train.rms * 1e3, 4)],
    [
      'largest error, training [mm]',
      (run) => numberCell(run.train.max * 1e3, 4)
    ],
    ['evaluation', (run) => run.evaluation || 'Jacobian'],
    ['time', (run) => cell(duration(run.time_s), run.time_s)],
  ];
  return table({
    id: 'solvers',
    caption: runs.length > 1 ? 'The solvers, on the same data' : 'The solver',
    columns: [
      {title: 'what'},
      ...runs.map(
          (run) => ({title: shortSolverTitle(run.name), align: 'right'}))
    ],
    rows: rows.map(([what, of]) => ({cells: [what, ...runs.map(of)]}))
  });
}

// The parameter on which two solvers agree least.
function disagreement(result) {
  const [first, second] = result.runs;
  if (!second || ['not_run', 'failed', 'unusable'].includes(second.status))
    return null;
  let worst = null;
  result.parameters.forEach((parameter, i) => {
    const difference = Math.abs(first.values[i] - second.values[i]);
    const known = knowledge(result, parameter);
    const size = difference / (known && known.std > 0 ? known.std : 1e-3);
    if (!worst || size > worst.size)
      worst = {parameter, difference, size, known};
  });
  if (!worst || worst.difference === 0)
    return p('Both end at the same values.');
  return p(
      `They differ most in ${worst.parameter.name}, by ` +
      quantity(worst.difference, worst.parameter.unit, 2) +
      (worst.known && worst.known.std > 0 ?
           `, ${num(worst.size, 2)} of its standard deviation.` :
           '.'));
}

function solverSection(entry) {
  const {runs} = entry.result;
  const message = entry.result.solver.message;
  return section(
      'solver', runs.length > 1 ? 'Solver against solver' : 'Convergence',
      p(`${solverTitle(entry.result.solver.name)} ` +
        `${statusTitle(entry.result.solver.status)} after ` +
        `${count(entry.result.solver.iterations, 'iteration')}` +
        (message ? `: ${message}.` : '.')),
      h('div', {class: 'pair'},
        convergenceFigure('convergence', 'Largest error by iteration', runs),
        solverTable(runs)),
      disagreement(entry.result));
}

function stagesSection(entry) {
  const {stages} = entry.result;
  if (!stages || stages.length === 0) return null;
  const of = (stage) => stage.heldout || stage.train;
  const seen = !stages[0].heldout;
  return section(
      'stages', 'Accuracy by stage',
      h('div', {class: 'pair'}, figure({
          id: 'stages-figure',
          title: 'Error by what was calibrated, ' +
              (seen ? 'training' : 'validation') + ' poses',
          draw: (width) => rowPlot(width, {
            rows: stages.map(
                (stage) => ({
                  label: stage.name,
                  marks: [
                    {
                      at: of(stage).mean * 1e3,
                      className: 'c2',
                      marker: 'circle',
                      size: 6,
                      tip: `${stage.name}: mean ${length(of(stage).mean)}`
                    },
                    {
                      at: of(stage).max * 1e3,
                      className: 'c1',
                      marker: 'square',
                      tip: `${stage.name}: largest ${length(of(stage).max)}`
                    }
                  ]
                })),
            x: {label: 'position error [mm]', zero: true},
            legend: [
              {label: 'mean', className: 'c2', marker: 'circle'},
              {label: 'largest', className: 'c1', marker: 'square'}
            ],
            description: 'Mean and largest error by stage'
          })
        }),
        table({
          id: 'stages-table',
          caption: 'Position error by stage [mm]',
          columns: [
            {title: 'calibrated'}, {title: 'free', align: 'right'},
            {title: 'mean', align: 'right'}, {title: 'RMS', align: 'right'},
            {title: '95 %', align: 'right'}, {title: 'largest', align: 'right'}
          ],
          rows: stages.map((stage) => ({
                             cells: [
                               stage.name, cell(String(stage.free), stage.free),
                               ...['mean', 'rms', 'p95', 'max'].map(
                                   (key) => numberCell(of(stage)[key] * 1e3))
                             ]
                           }))
        })));
}

function provenanceSection(entry) {
  const {result} = entry;
  const facts = [
    ['arm', result.arm], ['command', h('code', {}, result.command)],
    ['Alidade', result.version], ['seed', result.seed],
    ['observations', observationsText(result)],
    [
      'time',
      `${duration(result.times.total_s)} in all, of which analysis ` +
          `${duration(result.times.identify_s)} and solving ` +
          duration(sum(result.runs.map((run) => run.time_s)))
    ]
  ];
  return section(
      'provenance', 'Provenance',
      h('dl', {class: 'facts'},
        facts.map(([name, value]) => [h('dt', {}, name), h('dd', {}, value)])),
      table({
        id: 'inputs',
        caption: 'Files read',
        columns: [{title: 'path'}, {title: 'SHA-256'}],
        rows: result.inputs.map(
            (input) => ({cells: [input.path, h('code', {}, input.sha256)]}))
      }),
      result.rejected_rows && result.rejected_rows.length > 0 && table({
        id: 'rejected',
        caption: 'Rows that measure nothing',
        columns:
            [{title: 'file'}, {title: 'line', align: 'right'}, {title: 'why'}],
        rows: result.rejected_rows.map(
            (row) => ({
              cells: [row.file, cell(String(row.line), row.line), row.reason]
            }))
      }),
      h('p', {},
        h('button', {
          type: 'button',
          class: 'tool',
          onclick: () => saveFile(
              fileName(result.title, '.json'), 'application/json',
              JSON.stringify(data, null, 2))
        },
          'Save all data of this page as JSON')));
}

function observationsText(result) {
  const {solver} = result;
  return `${count(solver.num_poses, 'pose')}, ${
             count(solver.num_residuals, 'equation')}, ` +
      `${count(solver.num_free, 'parameter')} solved for`;
}
