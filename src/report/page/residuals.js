// Residuals after calibration: by pose, by joint value, as a histogram with the
// curve that was expected; outliers.

// Errors of a table in mm, or in degrees where no length was measured.
function errorColumns(table) {
  const columns = table.columns;
  const lengths = columns.after_error_mm.some(isNumber);
  return lengths || !columns.after_rotation_deg ?
      {
        before: columns.before_error_mm,
        after: columns.after_error_mm,
        label: 'position error [mm]',
        unit: 'mm'
      } :
      {
        before: columns.before_rotation_deg,
        after: columns.after_rotation_deg,
        label: 'orientation error [°]',
        unit: '°'
      };
}

function observationTip(table, i, value, unit) {
  const {pose, where, target} = table.columns;
  return `pose ${pose[i]}${target && target[i] ? ', ' + target[i] : ''}: ` +
      `${num(value)} ${unit}${
             where && where[i] ? '\n' + where[i].split('/').pop() : ''}`;
}

function poseFigure(id, title, table) {
  const errors = errorColumns(table);
  const values = errors.after;
  return figure({
    id,
    title,
    draw: (width) => plot(width, {
      x: {
        label: 'observation, in order',
        integer: true,
        min: 0,
        max: table.total + 1
      },
      y: {label: errors.label, zero: true},
      layers: [{
        type: values.length > 800 ? 'points' : 'stems',
        marker: 'circle',
        size: values.length > 800 ? 1.5 : 2.5,
        className: 'c2',
        x: table.index,
        y: values,
        tip: (i) => observationTip(table, i, values[i], errors.unit)
      }],
      description:
          `${errors.label} of ${count(values.length, 'observation')}, ` +
          `largest ${num(maxOf(values.filter(isNumber)))}`
    })
  });
}

// Errors against one joint's values; the joint is chosen by the reader.
function jointFigure(table, setName) {
  const joints = Object.keys(table.columns).filter((key) => /^q\d+_/.test(key));
  if (joints.length === 0) return null;
  const numberOf = (key) => key.match(/\d+/)[0];
  let joint = joints[0];
  const select = h(
      'select', {
        'aria-label': 'joint',
        onchange: (event) => {
          joint = event.target.value;
          shown.redraw();
        }
      },
      joints.map((key) => h('option', {value: key}, 'joint ' + numberOf(key))));
  const shown = figure({
    id: 'by-joint',
    title: `Error by joint value, ${setName} poses`,
    controls: h('div', {class: 'controls'}, h('label', {}, 'against ', select)),
    draw: (width) => drawByJoint(width, table, joint, numberOf(joint)),
    note: 'A pattern that is left after calibration is what the model does ' +
        'not have: compliance, gears, backlash.'
  });
  return shown;
}

function drawByJoint(width, table, joint, number) {
  const errors = errorColumns(table);
  const layer = (which, className, marker) => ({
    type: 'points',
    className,
    marker,
    label: which,
    x: table.columns[joint],
    y: errors[which],
    tip: (i) => observationTip(table, i, errors[which][i], errors.unit)
  });
  const before = maxOf(errors.before.filter(isNumber));
  const after = maxOf(errors.after.filter((v) => isNumber(v) && v > 0));
  return plot(width, {
    x: {label: `joint ${number} [${joint.endsWith('_deg') ? '°' : 'mm'}]`},
    y: {label: errors.label, zero: true, log: before > 50 * after && after > 0},
    layers: [layer('before', 'c1', 'square'), layer('after', 'c2', 'circle')],
    description:
        `${errors.label} before and after, by the value of joint ` + number
  });
}

// Counts of standardised residuals where they were computed; else the
// coordinates of the residuals and a normal of their own spread: {lower, width,
// counts, sigma, label, expected}.
function histogramData(entry) {
  const uncertainty = entry.result.uncertainty;
  const computed = uncertainty && uncertainty.residuals.studentised_histogram;
  if (computed && sum(computed.counts) > 0) {
    return {
      ...computed,
      sigma: 1,
      expected: 'standard normal',
      label: 'residual / its standard deviation'
    };
  }
  const columns = entry.tables.residuals && entry.tables.residuals.columns;
  if (!columns) return null;
  const values = ['x', 'y', 'z']
                     .flatMap((axis) => columns[`after_d${axis}_mm`])
                     .filter((v) => isNumber(v) && v !== 0);
  if (values.length < 8) return null;
  const sigma = Math.sqrt(sum(values.map((v) => v * v)) / values.length);
  const reach =
      Math.max(3.5 * sigma, Math.min(6 * sigma, maxOf(values.map(Math.abs))));
  const bins = Math.max(
      9, Math.min(41, 2 * Math.ceil(Math.sqrt(values.length) / 2) + 1));
  const width = 2 * reach / bins;
  const counts = Array(bins).fill(0);
  for (const value of values) {
    ++counts[Math.max(
        0, Math.min(bins - 1, Math.floor((value + reach) / width)))];
  }
  return {
    lower: -reach,
    width,
    counts,
    sigma,
    label: 'residual of a coordinate, training poses [mm]',
    expected: `normal, σ = ${num(sigma, 2)} mm`
  };
}

// Counts of bins, and the normal curve of `sigma` that was expected.
function histogramFigure(id, title, shown) {
  if (!shown) return null;
  const {lower, width: wide, counts, sigma} = shown;
  const upper = lower + wide * counts.length;
  const total = sum(counts);
  const curveX = Array.from(
      {length: 121}, (unused, i) => lower + i * (upper - lower) / 120);
  const curveY = curveX.map(
      (x) => total * wide / (sigma * Math.sqrt(2 * Math.PI)) *
          Math.exp(-0.5 * (x / sigma) ** 2));
  const x0 = counts.map((unused, i) => lower + i * wide);
  return figure({
    id,
    title,
    draw: (width) => plot(width, {
      x: {label: shown.label, min: lower, max: upper},
      y: {label: 'number', zero: true},
      layers: [
        {
          type: 'bars',
          className: 'c2',
          label: 'observed',
          x0,
          x1: x0.map((v) => v + wide),
          y: counts,
          tip: (i) => `${num(x0[i])} to ${num(x0[i] + wide)}: ${counts[i]}`
        },
        {
          type: 'line',
          className: 'c1',
          label: 'expected: ' + shown.expected,
          x: curveX,
          y: curveY
        }
      ],
      description:
          `Histogram of ${count(total, 'residual')} with the expected ` +
          'normal curve'
    }),
    note: 'The outermost bars hold all that is beyond them.'
  });
}

function outlierTable(result) {
  const {fit} = result;
  if (!fit || fit.outliers.length === 0) return null;
  return table({
    id: 'outliers',
    caption: `Outliers (${fit.outliers.length})`,
    columns: [
      {title: 'pose', align: 'right'}, {title: 'kind'}, {title: 'target'},
      {title: 'where'}, {title: 'error', unit: 'mm', align: 'right'},
      {title: 'standardised', align: 'right', help: 'in standard deviations'},
      {title: 'weight', align: 'right', help: 'what the robust loss left it'}
    ],
    rows: fit.outliers.slice(0, 200).map(
        (outlier) => ({
          cells: [
            cell(
                outlier.pose < 0 ? '–' : String(outlier.pose + 1),
                outlier.pose + 1),
            outlier.kind, outlier.target, outlier.where,
            numberCell(outlier.error * 1e3), numberCell(outlier.standardised),
            numberCell(outlier.weight, 2)
          ]
        }))
  });
}

function influenceTable(influence) {
  if (!influence) return null;
  const {
    pose,
    leverage,
    cooks_distance: distance,
    standardised_residual: residual
  } = influence.columns;
  const worst = pose.map((unused, i) => i)
                    .sort((a, b) => distance[b] - distance[a])
                    .slice(0, 8);
  return table({
    id: 'influence',
    caption: 'Influential poses',
    columns: [
      {title: 'pose', align: 'right'}, {
        title: 'Cook\'s distance',
        align: 'right',
        help: 'how far the fit moves ' +
            'without it, in its own uncertainty'
      },
      {title: 'leverage', align: 'right'},
      {title: 'standardised residual', align: 'right'}
    ],
    rows: worst.map((i) => ({
                      cells: [
                        cell(String(pose[i]), pose[i]), numberCell(distance[i]),
                        numberCell(leverage[i]), numberCell(residual[i])
                      ]
                    }))
  });
}

function residualsSection(entry) {
  const train = entry.tables.residuals;
  const heldout = entry.tables.heldout;
  const shown = heldout || train;
  const thinnedNote =
      [train, heldout].some((t) => t && t.index.length < t.total) &&
      note(
          'Figures of many observations show some of them, the worst always; ' +
          'tables and statistics are of all, and the CSV files hold every one.');
  return section(
      'residuals', 'Residuals',
      findingText(entry.result, /^(sigma|chi_square|normality|whiteness)$/),
      h('div', {class: 'pair'},
        histogramFigure(
            'histogram', 'Are the residuals like noise?', histogramData(entry)),
        shown && jointFigure(shown, heldout ? 'validation' : 'training')),
      h('div', {class: 'pair'},
        train &&
            poseFigure(
                'by-pose', 'Error after calibration, training poses', train),
        heldout &&
            poseFigure(
                'by-pose-heldout', 'Error after calibration, validation poses',
                heldout)),
      thinnedNote, findingText(entry.result, /^outliers$/),
      outlierTable(entry.result), influenceTable(entry.tables.influence));
}
