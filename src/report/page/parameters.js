// Parameters: what was found, and how well it is known.

// What people call the block of a parameter: targets and references have names
// of their own.
function parameterTitle(result, parameter) {
  const alias =
      (result.aliases || []).find((item) => item.block === parameter.kind);
  return alias ? `${parameter.name} (${alias.name})` : parameter.name;
}

// How well a parameter is known: {std, lower, upper, profile}, in SI; nothing
// where nobody computed it.
function knowledge(result, parameter) {
  const uncertainty = result.uncertainty;
  const mine = uncertainty &&
      uncertainty.parameters.find((item) => item.name === parameter.name);
  if (mine) {
    // JSON has no infinity.
    return {
      std: isNumber(mine.std) ? mine.std : Infinity,
      lower: mine.interval && mine.interval.lower,
      upper: mine.interval && mine.interval.upper,
      profile: mine.interval && mine.interval.profile
    };
  }
  if (parameter.state !== 'free') return null;
  const std = isNumber(parameter.std) ? parameter.std : parameter.predicted_std;
  if (isNumber(std)) return {std};
  // JSON has no infinity: none, where others have one, is that of a parameter
  // that these data do not determine.
  const others =
      result.parameters.some((other) => isNumber(other.predicted_std));
  return others ? {std: Infinity} : null;
}

// How a parameter came to its value: its badge, and in words.
const ASSESSMENTS = {
  estimated: ['good', 'estimated'],
  prior_dominated: ['warn', 'prior-dominated'],
  weak: ['warn', 'weakly identifiable'],
  fixed: ['plain', 'fixed'],
  known: ['plain', 'known']
};

// The cells of a parameter by the key of their column.
function parameterCells(result, parameter) {
  const {unit} = parameter;
  const decimals = isAngle(unit) ? 5 : 4;
  const blank = cell('', null);
  const shown = (value) => fixedCell(inUnit(value, unit), decimals);
  const cells = {
    name: parameterTitle(result, parameter),
    state: badge(...ASSESSMENTS[parameter.assessment]),
    unit: unitName(unit),
    nominal: shown(parameter.nominal),
    truth: isNumber(parameter.truth) ? shown(parameter.truth) : blank,
    published: isNumber(parameter.published) ? shown(parameter.published) :
                                               blank,
    why: whyText(result, parameter),
    change: blank,
    std: blank,
    sigmas: blank,
    interval: blank,
    found: blank
  };
  if (parameter.state !== 'free') return cells;
  cells.found = shown(parameter.value);
  const change = inUnit(parameter.deviation, unit);
  cells.change = cell(signed(fixed(change, decimals)), change);
  const known = knowledge(result, parameter);
  if (!known) return cells;
  cells.std = numberCell(inUnit(known.std, unit), 2);
  cells.interval = intervalCell(known, unit, decimals);
  if (known.std > 0 && isFinite(known.std)) {
    const sigmas = parameter.deviation / known.std;
    cells.sigmas = cell(signed(num(sigmas, 2)), sigmas);
  }
  return cells;
}

function whyText(result, parameter) {
  const known = knowledge(result, parameter);
  return [
    parameter.stands_for && `identified combination: ${parameter.stands_for}`,
    parameter.assessment === 'weak' &&
        'linearly dependent on others at the nominal geometry but for effects of second order, ' +
            'which are below the noise level',
    known && known.profile && 'interval by profile likelihood', parameter.reason
  ].filter(Boolean)
      .join('; ');
}

function intervalCell(known, unit, decimals) {
  if (!isNumber(known.lower) || !isNumber(known.upper)) return cell('', null);
  return cell(
      `${fixed(inUnit(known.lower, unit), decimals)} … ` +
          fixed(inUnit(known.upper, unit), decimals),
      inUnit(known.lower, unit));
}

function parameterTable(result) {
  const parameters = [
    ...result.parameters.filter((q) => q.state === 'free'),
    ...result.parameters.filter((q) => q.state !== 'free')
  ];
  const confidence = result.uncertainty ?
      percent(result.uncertainty.confidence) + ' interval' :
      'interval';
  const right = (key, title, help) => ({key, title, help, align: 'right'});
  const columns = [
    {key: 'name', title: 'name'}, {key: 'state', title: 'state'},
    right('change', 'change', 'found less nominal'),
    right('std', 'std', 'standard deviation of what was found'),
    {key: 'unit', title: 'unit'},
    right(
        'sigmas', 'change / std',
        'change against nominal in units of its own standard deviation'),
    right('interval', confidence), right('nominal', 'nominal'),
    right('found', 'found'),
    right('truth', 'true', 'known, because the arm is simulated'),
    right('published', 'published', result.published_source),
    {key: 'why', title: 'remarks', align: 'why'}
  ];
  const rows = parameters.map(
      (parameter) => ({
        cells: parameterCells(result, parameter),
        className: parameter.state === 'free' ? undefined : 'held'
      }));
  const kept = columns.filter(
      ({key}) => rows.some((row) => rawValue(row.cells[key]) !== ''));
  return table({
    id: 'parameters-table',
    caption: 'All parameters',
    columns: kept,
    rows: rows.map(
        (row) => ({...row, cells: kept.map(({key}) => row.cells[key])}))
  });
}

// Changes with their uncertainty, lengths and angles apart.
function changeFigure(result, unit) {
  const free = result.parameters.filter(
      (parameter) => parameter.state === 'free' && parameter.unit === unit &&
          !/^(base|point|plane|tool)/.test(parameter.kind));
  if (free.length === 0) return null;
  const name = isAngle(unit) ? 'Angles' : 'Lengths';
  const rows = free.map((parameter) => changeRow(result, parameter));
  const hasTruth = free.some((parameter) => isNumber(parameter.truth));
  const [low, high] = usefulRange(rows);
  return figure({
    id: 'changes-' + (isAngle(unit) ? 'angles' : 'lengths'),
    title: `${name}: change against nominal`,
    draw: (width) => rowPlot(width, {
      rows,
      x: {label: `change [${unitName(unit)}]`, zero: true, low, high},
      vlines: [{x: 0}],
      legend: hasTruth &&
          [
            {label: 'found', className: 'c2', marker: 'circle'},
            {label: 'true', className: 'hollow', marker: 'square'}
          ],
      description: `${name} of the joints: change against nominal with its ` +
          'interval, ' + free.map((parameter) => parameter.name).join(', ')
    }),
    note: rows.some(
              (row) => row.marks.some(
                  (mark) => mark.lower < low || mark.upper > high)) ?
        'Bars that end in an arrow reach beyond the figure.' :
        undefined
  });
}

// Of a weakly identifiable parameter the bar would leave no room for others: it
// is cut at four times the reach of all changes and usual bars.
function usefulRange(rows) {
  const marks = rows.flatMap((row) => row.marks);
  const reach = marks.map(
      (mark) => Math.max(
          Math.abs(mark.at),
          isNumber(mark.upper) ? Math.abs(mark.upper - mark.lower) / 2 : 0));
  const largest = 4 *
      Math.max(maxOf(marks.map((mark) => Math.abs(mark.at))), median(reach));
  const kept = marks.flatMap((mark) => [mark.at, mark.lower, mark.upper])
                   .filter((v) => isNumber(v) && Math.abs(v) <= largest);
  return [minOf(kept), maxOf(kept)];
}

function changeRow(result, parameter) {
  const {unit} = parameter;
  const known = knowledge(result, parameter);
  const shift = (value) => inUnit(value - parameter.nominal, unit);
  const mark = {
    at: shift(parameter.value),
    className: 'c2',
    tip: `${parameter.name}: ${signed(num(shift(parameter.value)))} ${
        unitName(unit)}`
  };
  if (known && known.std === Infinity) {
    [mark.lower, mark.upper] = [-Infinity, Infinity];
    mark.tip += '\nnot determined by these poses';
  } else if (known && isNumber(known.std)) {
    const reach = 1.96 * known.std;
    mark.lower =
        shift(isNumber(known.lower) ? known.lower : parameter.value - reach);
    mark.upper =
        shift(isNumber(known.upper) ? known.upper : parameter.value + reach);
    mark.tip +=
        `\n± ${num(inUnit(known.std, unit), 2)} ${unitName(unit)} (1 std)`;
  }
  const marks = [mark];
  if (isNumber(parameter.truth)) {
    marks.unshift({
      at: shift(parameter.truth),
      className: 'hollow',
      marker: 'square',
      size: 5
    });
  }
  return {label: parameter.name, marks};
}

function parametersSection(entry) {
  const result = entry.result;
  const told =
      result.parameters.some((parameter) => knowledge(result, parameter));
  const predicted = !result.uncertainty && told;
  const parts =
      Object.entries(ASSESSMENTS)
          .map(
              ([key, [, words]]) =>
                  [result.parameters
                       .filter((parameter) => parameter.assessment === key)
                       .length,
                   words])
          .filter(([number]) => number > 0)
          .map(([number, words]) => `${number} ${words}`);
  return section(
      'parameters', 'Parameters',
      p(`Of ${count(result.parameters.length, 'parameter')}: ${
          parts.join(', ')}.`),
      predicted &&
          note(
              'Standard deviations are those predicted from the poses ' +
              'and the stated or estimated accuracy of the instrument; bars are 95 % ' +
              'intervals by them.'),
      !told &&
          note('No standard deviations were computed for these parameters.'),
      h('div', {class: 'pair'}, changeFigure(result, 'm'),
        changeFigure(result, 'rad')),
      parameterTable(result), correlatedTable(result));
}

function correlatedTable(result) {
  const pairs = result.uncertainty && result.uncertainty.correlated || [];
  if (pairs.length === 0) return null;
  return table({
    id: 'correlated',
    caption: 'Strongly correlated parameters',
    columns: [
      {title: 'first'}, {title: 'second'},
      {title: 'correlation', align: 'right'}
    ],
    rows: pairs.map(
        (pair) => (
            {cells: [pair.first, pair.second, fixedCell(pair.correlation, 3)]}))
  });
}
