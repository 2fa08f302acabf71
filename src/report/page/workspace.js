// How accurate the calibrated arm is predicted to be over its workspace: slices
// through a map of drawn configurations, and what was then observed.

const CUTS = {
  z: {across: ['x', 'y'], title: 'height z'},
  y: {across: ['x', 'z'], title: 'y'},
  x: {across: ['y', 'z'], title: 'x'},
};

// Means of `values` in square cells of a slab of the workspace.
function sliceCells(columns, values, cut, low, high, side) {
  const [a, b] = CUTS[cut].across.map((axis) => columns[axis + '_mm']);
  const depth = columns[cut + '_mm'];
  const cells = new Map();
  values.forEach((value, i) => {
    if (!isNumber(value) || depth[i] < low || depth[i] > high) return;
    const key = Math.floor(a[i] / side) + ',' + Math.floor(b[i] / side);
    const found = cells.get(key) || {
      sum: 0,
      n: 0,
      x: (Math.floor(a[i] / side) + 0.5) * side,
      y: (Math.floor(b[i] / side) + 0.5) * side
    };
    found.sum += value;
    found.n += 1;
    cells.set(key, found);
  });
  return [...cells.values()];
}

function mapFigure(map) {
  const slice = {cut: 'z', place: 0.5};
  const said = h('output', {class: 'small'});
  const select =
      h('select', {
        'aria-label': 'direction of the slice',
        onchange: (event) => {
          slice.cut = event.target.value;
          shown.redraw();
        }
      },
        Object.keys(CUTS).map(
            (key) => h('option', {value: key}, `across ${CUTS[key].title}`)));
  const place = slider('where the slice lies', 100, 50, (value) => {
    slice.place = value / 100;
    shown.redraw();
  });
  const shown = figure({
    id: 'predicted-map',
    title: 'Predicted standard deviation of the position',
    controls:
        h('div', {class: 'controls'}, h('label', {}, 'Slice ', select),
          h('label', {}, 'at ', place), said),
    draw: (width) => drawSlice(width, map.columns, slice, said)
  });
  return shown;
}

// A fifth of the workspace across `slice.cut`; `said` tells which.
function drawSlice(width, columns, slice, said) {
  const depth = columns[slice.cut + '_mm'];
  const [low, high] = [minOf(depth), maxOf(depth)];
  const thick = (high - low) / 5;
  const from = low + slice.place * (high - low - thick);
  const spans = CUTS[slice.cut]
                    .across.map((axis) => columns[axis + '_mm'])
                    .map((values) => maxOf(values) - minOf(values));
  const side = niceStep(maxOf(spans), 22);
  const cells = sliceCells(
      columns, columns.position_std_mm, slice.cut, from, from + thick, side);
  said.textContent = `${CUTS[slice.cut].title} from ${num(from)} to ` +
      `${num(from + thick)} mm`;
  return sliceMap(width, cells, slice.cut, side);
}

function sliceMap(width, cells, cut, side) {
  const [a, b] = CUTS[cut].across;
  const means = cells.map((item) => item.sum / item.n);
  if (cells.length === 0) {
    return canvas(width, 40, 'no configuration lies in this slice');
  }
  return mapPlot(width, {
    size: side,
    x: {label: a + ' [mm]', values: cells.map((item) => item.x)},
    y: {label: b + ' [mm]', values: cells.map((item) => item.y)},
    value: {label: 'std [mm]', values: means},
    tip: (i) => `${num(means[i])} mm\n${count(cells[i].n, 'configuration')}`,
    description:
        `Map of the predicted standard deviation, ${num(minOf(means))} ` +
        `to ${num(maxOf(means))} mm in this slice`
  });
}

// Predicted against true error where the true arm is known.
function truthFigure(map) {
  const truth = map.columns.true_error_mm;
  if (!truth || !truth.some((v) => isNumber(v) && v > 0)) return null;
  const predicted = map.columns.position_std_mm;
  const both = predicted.map((v, i) => [v, truth[i]])
                   .flat()
                   .filter((v) => isNumber(v) && v > 0);
  const range = [minOf(both), maxOf(both)];
  return figure({
    id: 'predicted-and-true',
    title: 'Predicted and true error',
    draw: (width) => plot(width, {
      x: {label: 'predicted standard deviation [mm]', log: true},
      y: {label: 'true error [mm]', log: true},
      layers: [
        {
          type: 'points',
          marker: 'circle',
          className: 'c2',
          size: 1.5,
          x: predicted,
          y: truth,
          label: 'a configuration'
        },
        {
          type: 'line',
          className: 'c1 dashed',
          x: range,
          y: range,
          label: 'equal'
        }
      ],
      description: 'True error against predicted standard deviation'
    }),
    note: 'The arm is simulated, so that its true error is known everywhere.'
  });
}

// Errors at validation poses over the standard deviations predicted for them.
function zScoreFigure(uncertainty) {
  const scores =
      uncertainty && uncertainty.heldout && uncertainty.heldout.z_histogram;
  if (!scores || sum(scores.counts) === 0) return null;
  return histogramFigure(
      'z-scores', 'Validation errors over their prediction', {
        ...scores,
        sigma: 1,
        expected: 'standard normal',
        label: 'error / predicted standard deviation'
      });
}

function workspaceSection(entry) {
  const {uncertainty} = entry.result;
  const map = entry.tables.predicted_map;
  const workspace = uncertainty && uncertainty.workspace;
  const summary = workspace && workspace.position_std;
  const truth = workspace && workspace.true_error;
  const observed = heldoutMaps(entry);
  if (!map && !uncertainty && !observed) return null;
  return section(
      'workspace', 'Predicted accuracy',
      summary &&
          p('Over the workspace the position is predicted to a standard ' +
            `deviation of ${length(summary.median)} in the median, ${
                length(summary.p95)} ` +
            `at 95 % of the configurations and ${
                length(summary.max)} at most.` +
            (truth ? ` The true error there, of the simulated arm, is ${
                         length(truth.median)}, ` +
                     `${length(truth.p95)} and ${length(truth.max)}.` :
                     '')),
      findingText(entry.result, /^prediction$/),
      h('div', {class: 'pair'}, map && mapFigure(map), map && truthFigure(map),
        zScoreFigure(uncertainty)),
      observed);
}

const liesInPlane = (columns) => {
  const spans = ['x', 'y', 'z'].map((axis) => {
    const values = columns[axis + '_mm'].filter(isNumber);
    return maxOf(values) - minOf(values);
  });
  return spans[2] < 0.05 * Math.max(spans[0], spans[1]);
};

// Validation poses of one plane make a map of what was observed.
function heldoutMaps(entry) {
  const heldout = entry.tables.heldout;
  if (!heldout || heldout.index.length < 50 || !liesInPlane(heldout.columns)) {
    return null;
  }
  return h(
      'div', {class: 'pair'},
      planeFigure(
          'map-before', 'Error before, validation poses', heldout, 'before'),
      planeFigure(
          'map-after', 'Error after, validation poses', heldout, 'after'));
}

function planeFigure(id, title, table, which) {
  const columns = table.columns;
  const values = columns[which + '_error_mm'];
  return figure({
    id,
    title,
    draw: (width) => mapPlot(width, {
      x: {label: 'x [mm]', values: columns.x_mm},
      y: {label: 'y [mm]', values: columns.y_mm},
      value: {label: 'error [mm]', values},
      tip: (i) => `pose ${columns.pose[i]}: ${num(values[i])} mm`,
      description: `Map of the position error, ${num(minOf(values))} to ` +
          `${num(maxOf(values))} mm`
    })
  });
}
