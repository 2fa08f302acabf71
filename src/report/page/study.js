// A published study beside ours: its five figures and its two tables.


// What the study says of a figure, and what came out here.
function publishedNote(study, pattern) {
  const rows = study.rows.filter((row) => pattern.test(row.quantity));
  if (rows.length === 0) return undefined;
  return rows
      .map(
          (row) => `Published, ${row.quantity}: ${row.published}. ` +
              `Here: ${row.obtained}.`)
      .join(' ');
}

function studyFigures(entry) {
  const {study, runs} = entry.result;
  const {residuals, heldout} = entry.tables;
  const validation = (id, title, which, pattern) => heldout &&
      (liesInPlane(heldout.columns) ?
           planeFigure(
               id, title, heldout, which, publishedNote(study, pattern)) :
           poseFigure(
               id, title, heldout, which, publishedNote(study, pattern)));
  return h(
      'div', {class: 'pair', id: 'study-figures'},
      residuals &&
          poseFigure(
              'study-1', 'Figure 1: error before, training poses', residuals,
              'before', publishedNote(study, /error before/)),
      residuals &&
          poseFigure(
              'study-2', 'Figure 2: error after, training poses', residuals,
              'after', publishedNote(study, /largest error after/)),
      convergenceFigure(
          'study-3', 'Figure 3: largest error by iteration', runs,
          publishedNote(study, /at iteration/)),
      validation(
          'study-4', 'Figure 4: error before, validation poses', 'before',
          /error before, validation/),
      validation(
          'study-5', 'Figure 5: error after, validation poses', 'after',
          /error after, validation/));
}

// Names end in the number of a joint: "beta1".
function nominalTable(study) {
  const kinds =
      [['beta', '°'], ['alpha', '°'], ['d', 'mm'], ['theta', '°'], ['r', 'mm']];
  const joints = new Map();
  for (const parameter of study.parameters) {
    const match = /^([a-z]+)(\d+)$/.exec(parameter.name);
    if (!match) continue;
    const joint = joints.get(Number(match[2])) || {};
    joint[match[1]] = inUnit(parameter.nominal, parameter.unit);
    joints.set(Number(match[2]), joint);
  }
  if (joints.size === 0) return null;
  return table({
    id: 'study-nominal',
    caption: 'Table 1: nominal parameters',
    columns: [
      {title: 'joint'},
      ...kinds.map(([title, unit]) => ({title, unit, align: 'right'}))
    ],
    rows: [...joints].map(
        ([number, joint]) => ({
          cells: [
            String(number), ...kinds.map(([kind]) => fixedCell(joint[kind], 4))
          ]
        }))
  });
}

// The study counts angles in rad and lengths in mm.
function deviationTable(study) {
  const of = (value, unit) => (isAngle(unit) ? value : value * 1e3);
  const percent = (value, assumed) => {
    if (assumed === 0) return cell('–', null);
    const error = 100 * Math.abs(value - assumed) / Math.abs(assumed);
    return cell(error < 1e-9 ? '0' : num(error), error);
  };
  const rows =
      study.parameters
          .filter(
              (parameter) => parameter.identified || parameter.assumed !== 0)
          .map((parameter) => {
            const {unit, assumed, published, obtained} = parameter;
            return {
              className: parameter.identified ? undefined : 'held',
              cells: [
                parameter.name, isAngle(unit) ? 'rad' : 'mm',
                fixedCell(of(assumed, unit), 4),
                fixedCell(
                    of(published, unit),
                    isAngle(unit) ? study.angle_decimals :
                                    study.length_decimals),
                fixedCell(of(obtained, unit), isAngle(unit) ? 8 : 6),
                percent(published, assumed), percent(obtained, assumed),
                parameter.identified ? 'yes' : 'no'
              ]
            };
          });
  return table({
    id: 'study-deviations',
    caption: 'Table 2: deviations from ' +
        'nominal',
    columns: [
      {title: 'name'}, {title: 'unit'},
      {title: 'assumed', align: 'right', help: 'of the real arm, as simulated'},
      {title: 'published', align: 'right'}, {title: 'here', align: 'right'},
      {title: 'published off', unit: '%', align: 'right'},
      {title: 'here off', unit: '%', align: 'right'}, {title: 'identified'}
    ],
    rows
  });
}

function absorptionText(study) {
  return study.absorptions.filter((item) => Math.abs(item.amount) > 1e-10)
      .map(
          (item) =>
              p(`${item.taken_up_by} takes up ${
                    quantity(item.amount, item.unit, 4)} of ${
                    item.frozen}, which is frozen but is not at its ` +
                'nominal value in the assumed arm.'));
}

function roundingText(result) {
  const {as_printed: printed, length_decimals: decimals} = result.study;
  if (!printed || printed.n === 0) return null;
  const full =
      result.accuracy.heldout ? result.accuracy.heldout.after.max : null;
  return p(
      'With the values rounded as the study prints them, the error over ' +
      `${count(printed.n, 'validation pose')} is ${
          length(printed.mean, 5)} in the ` +
      `mean and ${length(printed.max, 5)} at most` +
      (full ?
           `; at full precision it is ${length(full)} at most. The published ` +
               `figure is that of a table with ${
                   count(decimals, 'decimal')} of a ` +
               'millimetre, not a limit of the calibration.' :
           '.'));
}

function studySection(entry) {
  const {study} = entry.result;
  if (!study) return null;
  return section(
      'study', 'The published study, and ours', p(study.source), table({
        id: 'study-rows',
        caption: 'Published and obtained',
        columns: [
          {title: 'quantity'}, {title: 'published', align: 'why'},
          {title: 'here', align: 'why'}
        ],
        rows: study.rows.map(
            (row) => ({cells: [row.quantity, row.published, row.obtained]}))
      }),
      roundingText(entry.result), absorptionText(study), studyFigures(entry),
      nominalTable(study), deviationTable(study));
}
