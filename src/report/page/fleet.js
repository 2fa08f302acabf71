// Many arms: how accurate each is, and which are outliers. What is one is
// decided where the page was made (comparison.h).

// Errors of a result at validation poses where there are any.
const judgedSet = (item) => item.heldout || item.train;

const fleetArms = ({results, fleet}) =>
    fleet.arms.map((arm) => ({...arm, item: results[arm.result]}));

// Links are paths, whatever characters are in them.
const pathLink = (path) =>
    './' + path.split('/').map(encodeURIComponent).join('/');
const labelNode = (item) =>
    (item.href ? h('a', {href: pathLink(item.href)}, item.label) : item.label);

function fleetFigure(arms) {
  const shown = arms.slice(0, 60);
  const rows = shown.map((arm) => {
    const set = judgedSet(arm.item);
    const mark = (which, className, marker) => ({
      at: set[which].mean * 1e3,
      className,
      marker,
      tip: `${arm.item.label}\n${which}: ` +
          `mean ${length(set[which].mean)}, largest ${length(set[which].max)}`
    });
    const marks =
        [mark('before', 'c1', 'square'), mark('after', 'c2', 'circle')];
    marks[1].lower = set.after.mean * 1e3;
    marks[1].upper = set.after.max * 1e3;
    return {
      label: (arm.outlier ? '▲ ' : '') + arm.item.label,
      marks,
      emphasised: arm.outlier
    };
  });
  return figure({
    id: 'fleet-accuracy',
    title: 'Position error of each arm, by score',
    draw: (width) => rowPlot(width, {
      rows,
      x: {label: 'mean position error [mm]', log: true},
      legend: [
        {label: 'before', className: 'c1', marker: 'square'},
        {label: 'after', className: 'c2', marker: 'circle'}
      ],
      description: 'Mean position error before and after calibration of ' +
          count(shown.length, 'arm')
    }),
    note: '▲ marks outliers. The line from the mean after calibration ' +
        'reaches to its largest error.' +
        (arms.length > shown.length ?
             ` The first ${shown.length} of ${arms.length} are drawn.` :
             '')
  });
}

// The parameter in which an arm differs most.
const differenceText = (parameter, arm) => parameter ?
    `${parameter.name} ${
        signed(quantity(arm.deviations[arm.most], parameter.unit))} ` +
        `(z\u00a0=\u00a0${num(arm.parameter_scores[arm.most], 2)})` :
    '–';

function fleetTable(comparison, arms) {
  const score = (z) => cell(
      isNumber(z) ? signed(Math.abs(z) < 100 ? fixed(z, 1) : num(z, 3)) : '–',
      z);
  const limited = arms.some((arm) => arm.item.limits > 0);
  const warned = arms.some((arm) => arm.item.warnings > 0);
  const rows = arms.map((arm) => {
    const {item} = arm;
    const set = judgedSet(item);
    return {
      className: arm.outlier ? 'outlier' : undefined,
      cells: [
        labelNode(item),
        badge(
            arm.outlier ? 'warn' : 'plain',
            arm.outlier ? 'outlier' : 'typical'),
        numberCell(set.before.mean * 1e3), numberCell(set.after.mean * 1e3),
        numberCell(set.after.max * 1e3),
        cell(grouped(set.after.n), set.after.n), ...arm.scores.map(score),
        differenceText(comparison.fleet.parameters[arm.most], arm),
        ...(limited ? [limitBadge(item)] : []),
        ...(warned ? [cell(String(item.warnings), item.warnings)] : [])
      ]
    };
  });
  const validated = arms.every((arm) => arm.item.heldout);
  return table({
    id: 'fleet',
    caption: 'Every arm, ' + (validated ? 'at validation poses, ' : '') +
        'the largest score first',
    columns: [
      {title: 'arm'}, {title: 'verdict', help: 'among the others'}, {
        title: 'before',
        unit: 'mm',
        align: 'right',
        help: 'mean position error'
      },
      {title: 'after', unit: 'mm', align: 'right', help: 'mean position error'},
      {title: 'largest', unit: 'mm', align: 'right', help: 'after calibration'},
      {title: 'n', align: 'right'}, {
        title: 'z before',
        align: 'right',
        help: 'modified z-score of the error before calibration'
      },
      {title: 'z after', align: 'right'}, {title: 'z geometry', align: 'right'},
      {title: 'differs most in', help: 'deviation from nominal'},
      ...(limited ? [{title: 'limits'}] : []),
      ...(warned ? [{title: 'warnings', align: 'right'}] : [])
    ],
    rows
  });
}

const limitBadge = (item) =>
    (item.limits === 0 ?
         badge('plain', 'none set') :
         badge(item.missed ? 'bad' : 'good', item.missed ? 'missed' : 'met'));

// Scores of all parameters as colours; numbers where they are beyond the
// threshold.
function scoreMap(fleet, arms) {
  const shown = arms.slice(0, 40);
  const columns = fleet.parameters.slice(0, 48);
  if (columns.length === 0 || shown.length < 3) return null;
  return figure({
    id: 'fleet-scores',
    title: 'Where each arm differs from the median arm',
    className: 'wide',
    draw: (width) => drawScores(width, shown, columns, fleet.threshold),
    note:
        'A column is a parameter, its colour how far it is from the median of ' +
        'all arms, in robust standard deviations: orange larger, blue smaller, ' +
        `grey typical. Numbers stand where it is more than ${
            fleet.threshold}. Empty: not estimated of that arm.`
  });
}

function scoreColour(z) {
  const t = Math.max(-1, Math.min(1, z / 6));
  const [end, share] = [
    t > 0 ? 'var(--c1, #d55e00)' : 'var(--c2, #0072b2)',
    Math.round(Math.abs(t) * 85 + 8)
  ];
  return `color-mix(in srgb, ${end} ${share}%, var(--grid, #e3e7eb))`;
}

function drawScores(width, arms, parameters, threshold) {
  const longest = maxOf(arms.map((arm) => arm.item.label.length + 2));
  const left = Math.min(longest * 7.4 + 16, width * 0.36);
  const wide = (width - left - 8) / parameters.length, tall = 20, top = 56;
  const svg = canvas(
      width, top + arms.length * tall + 8,
      'Robust scores of ' + count(parameters.length, 'parameter') + ' of ' +
          count(arms.length, 'arm'));
  const spots = [];
  parameters.forEach(
      (parameter, k) => svg.append(
          s('text', {
            class: 'tick',
            transform:
                `translate(${round(left + (k + 0.5) * wide + 4)} ${top - 6}) ` +
                'rotate(-60)'
          },
            parameter.name)));
  arms.forEach((arm, i) => {
    const y = top + i * tall;
    const fits = Math.floor((left - 10) / 6.4);
    const label = (arm.outlier ? '▲ ' : '') + arm.item.label;
    svg.append(words(
        left - 8, y + 14,
        label.length > fits ? label.slice(0, fits - 1) + '…' : label,
        arm.outlier ? 'row-label strong' : 'row-label', 'end'));
    parameters.forEach((parameter, k) => {
      const z = arm.parameter_scores[k];
      if (!isNumber(z)) return;
      const x = left + k * wide;
      svg.append(s('rect', {
        x: round(x),
        y,
        width: round(wide - 1),
        height: tall - 1,
        style: `fill: ${scoreColour(z)}`
      }));
      if (Math.abs(z) > threshold && wide > 17) {
        svg.append(
            words(round(x + wide / 2), y + 14, fixed(z, 0), 'score', 'middle'));
      }
      spots.push({
        x: x + wide / 2,
        y: y + tall / 2,
        text: `${arm.item.label}, ${parameter.name}:\n` +
            `${signed(quantity(arm.deviations[k], parameter.unit))} ` +
            `against nominal, z = ${fixed(z, 1)}`
      });
    });
  });
  attachTips(svg, spots);
  return svg;
}

function fleetView(comparison) {
  const {fleet} = comparison;
  const arms = fleetArms(comparison);
  const outliers = arms.filter((arm) => arm.outlier);
  return [
    outliers.length > 1 &&
        h('ul', {class: 'plain', id: 'outlying-arms'},
          outliers.slice(0, 8).map(
              (arm) =>
                  h('li', {}, h('strong', {}, arm.item.label),
                    ': ' + arm.reasons.join('; ') + '.'))),
    fleetFigure(arms),
    fleet.small &&
        note(
            `${
                count(
                    arms.length,
                    'arm')}: too few for statistics. Scores show ` +
            'only which is farthest from the others, and a difference of less ' +
            'than a third of the median error never makes an outlier.'),
    fleetTable(comparison, arms),
    note(
        'z is the distance from the median arm in robust standard deviations. ' +
        `An arm with one of its three above ${fleet.threshold} is an outlier.`),
    scoreMap(fleet, arms)
  ];
}
