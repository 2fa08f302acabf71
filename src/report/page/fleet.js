// Many arms: how accurate each is, and which is unlike the others.

// Beyond this many robust standard deviations an arm is called odd.
const ODD = 3.5;
const JOINT_KINDS = ['beta', 'alpha', 'd', 'theta', 'r'];

// What is judged of a result of a comparison: poses it has not seen where there
// are any.
const judgedSet = (item) => item.heldout || item.train;

// (value - median) / spread, the spread being that of the middle half (1.4826
// times the median absolute deviation), but no less than `floor(median)`.
function robustScores(values, floor) {
  const centre = median(values);
  const spread = 1.4826 * median(values.map((v) => Math.abs(v - centre)));
  const scale = Math.max(spread, floor(centre));
  return values.map(
      (v) => (isNumber(v) && scale > 0 ? (v - centre) / scale : NaN));
}

// Every joint parameter that is free in three arms or more: {name, unit,
// deviations, scores}, one entry per arm, NaN where it is not free.
function fleetParameters(comparison) {
  const all = new Map();
  comparison.results.forEach((item, i) => {
    const layout = comparison.layouts[item.layout];
    layout.names.forEach((name, k) => {
      if (!JOINT_KINDS.includes(layout.kinds[k]) || item.states[k] !== 'f')
        return;
      if (!all.has(name)) {
        all.set(name, {
          name,
          unit: layout.units[k],
          kind: layout.kinds[k],
          deviations: Array(comparison.results.length).fill(NaN),
          stds: []
        });
      }
      all.get(name).deviations[i] = item.deviation[k];
      if (isNumber(item.std[k])) all.get(name).stds.push(item.std[k]);
    });
  });
  const parameters = [...all.values()].filter(
      (parameter) => parameter.deviations.filter(isNumber).length >= 3);
  for (const parameter of parameters) {
    const known = parameter.stds.length > 0 ? median(parameter.stds) : 1e-6;
    parameter.scores = robustScores(parameter.deviations, () => known);
  }
  return parameters;
}

// Root mean square of an arm's scores, none counting more than 10: about 1 for
// an arm like the others.
const unlikeness = (scores) => {
  const usable = scores.filter(isNumber).map((z) => Math.min(Math.abs(z), 10));
  return usable.length > 0 ?
      Math.sqrt(sum(usable.map((z) => z * z)) / usable.length) :
      NaN;
};

// What is told of each arm, the oddest first.
function fleetArms(comparison, parameters) {
  const {results} = comparison;
  const tenth = (centre) => 0.1 * centre;
  const means = (which) => results.map((item) => judgedSet(item)[which].mean);
  const before = robustScores(means('before'), tenth);
  const after = robustScores(means('after'), tenth);
  const geometry = results.map(
      (item, i) =>
          unlikeness(parameters.map((parameter) => parameter.scores[i])));
  const geometryScores = robustScores(geometry, () => 0.3);
  const arms = results.map((item, i) => {
    const most =
        [...parameters]
            .filter((q) => isNumber(q.scores[i]))
            .sort((a, b) => Math.abs(b.scores[i]) - Math.abs(a.scores[i]))[0];
    const scores = {
      before: before[i],
      after: after[i],
      geometry: geometryScores[i]
    };
    const largest = maxOf(Object.values(scores).filter(isNumber).concat(0));
    return {
      index: i,
      item,
      scores,
      geometry: geometry[i],
      most,
      largest,
      odd: largest > ODD
    };
  });
  return arms.sort((a, b) => b.largest - a.largest);
}

// Why an arm is odd, in words.
function oddReasons(arm, arms) {
  const set = judgedSet(arm.item);
  const typical = (which) =>
      median(arms.map((other) => judgedSet(other.item)[which].mean));
  const reasons = [];
  if (arm.scores.before > ODD) {
    reasons.push(
        `${length(set.before.mean)} off before calibration, where ` +
        `${length(typical('before'))} is usual`);
  }
  if (arm.scores.after > ODD) {
    reasons.push(
        `${length(set.after.mean)} left after calibration, where ` +
        `${length(typical('after'))} is usual`);
  }
  if (arm.scores.geometry > ODD && arm.most) {
    reasons.push(
        `its geometry is unlike the others', most of all ` +
        `${arm.most.name} (${
            signed(quantity(arm.most.deviations[arm.index], arm.most.unit))})`);
  }
  return reasons;
}

function fleetVerdict(arms, failures) {
  const odd = arms.filter((arm) => arm.odd);
  const number = count(arms.length, 'arm');
  const failed = failures.length > 0 ?
      ` ${count(failures.length, 'calibration')} failed.` :
      '';
  if (odd.length === 0) {
    return {
      kind: failures.length ? 'bad' : 'good',
      word: failures.length ? 'Failures' : 'No arm is odd',
      sentence: `None of ${number} is unlike the others.${failed}`
    };
  }
  if (odd.length === 1) {
    return {
      kind: 'warn',
      word: 'One arm is odd',
      sentence: `${odd[0].item.label} is the odd one of ${number}: ` +
          `${oddReasons(odd[0], arms).join('; ')}.${failed}`
    };
  }
  const names = odd.slice(0, 4).map((arm) => arm.item.label).join(', ') +
      (odd.length > 4 ? ` and ${odd.length - 4} more` : '');
  return {
    kind: 'warn',
    word: `${odd.length} arms are odd`,
    sentence: `${odd.length} of ${number} are odd: ${names}.${failed}`
  };
}

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
      label: (arm.odd ? '▲ ' : '') + arm.item.label,
      marks,
      emphasised: arm.odd
    };
  });
  return figure({
    id: 'fleet-accuracy',
    title: 'Position error of each arm, the ' +
        'oddest first',
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
    note:
        '▲ marks arms that are odd. The line from the mean after calibration ' +
        'reaches to its largest error.' +
        (arms.length > shown.length ?
             ` The ${shown.length} oddest of ${arms.length} are drawn.` :
             '')
  });
}

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
      className: arm.odd ? 'odd' : undefined,
      cells: [
        labelNode(item),
        badge(arm.odd ? 'warn' : 'plain', arm.odd ? 'odd' : 'like others'),
        numberCell(set.before.mean * 1e3), numberCell(set.after.mean * 1e3),
        numberCell(set.after.max * 1e3),
        cell(grouped(set.after.n), set.after.n), score(arm.scores.before),
        score(arm.scores.after), score(arm.scores.geometry),
        arm.most ? `${arm.most.name} ${
                       signed(quantity(
                           arm.most.deviations[arm.index],
                           arm.most.unit))} (z\u00a0=\u00a0` +
                `${num(arm.most.scores[arm.index], 2)})` :
                   '–',
        ...(limited ? [limitBadge(item)] : []),
        ...(warned ? [cell(String(item.warnings), item.warnings)] : [])
      ]
    };
  });
  const seen = arms.some((arm) => !arm.item.heldout);
  return table({
    id: 'fleet',
    caption: 'Every arm, ' +
        (seen ? '' :
                'at poses the ' +
                 'fit has not seen, ') +
        'the oddest first',
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
        help: 'how far its error before is ' +
            'from the median arm, in robust standard deviations'
      },
      {title: 'z after', align: 'right'}, {title: 'z geometry', align: 'right'},
      {title: 'most unlike in'}, ...(limited ? [{title: 'limits'}] : []),
      ...(warned ? [{title: 'warnings', align: 'right'}] : [])
    ],
    rows
  });
}

const limitBadge = (item) =>
    (item.limits === 0 ?
         badge('plain', 'none set') :
         badge(item.missed ? 'bad' : 'good', item.missed ? 'missed' : 'met'));

// Scores of all parameters as colours; numbers where they are beyond ODD.
function scoreMap(arms, parameters) {
  const shown = arms.slice(0, 40);
  const usable =
      parameters.filter((parameter) => JOINT_KINDS.includes(parameter.kind))
          .slice(0, 48);
  if (usable.length === 0 || shown.length < 3) return null;
  return figure({
    id: 'fleet-scores',
    title: 'Where each arm differs from the ' +
        'median arm',
    className: 'wide',
    draw: (width) => drawScores(width, shown, usable),
    note:
        'A column is a parameter, its colour how far it is from the median of ' +
        'all arms, in robust standard deviations: orange larger, blue smaller, ' +
        `grey like the others. Numbers stand where it is more than ${
            ODD}. Empty: ` +
        'not identified of that arm.'
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

function drawScores(width, arms, parameters) {
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
    const label = (arm.odd ? '▲ ' : '') + arm.item.label;
    svg.append(words(
        left - 8, y + 14,
        label.length > fits ? label.slice(0, fits - 1) + '…' : label,
        arm.odd ? 'row-label strong' : 'row-label', 'end'));
    parameters.forEach((parameter, k) => {
      const z = parameter.scores[arm.index];
      if (!isNumber(z)) return;
      const x = left + k * wide;
      svg.append(s('rect', {
        x: round(x),
        y,
        width: round(wide - 1),
        height: tall - 1,
        style: `fill: ${scoreColour(z)}`
      }));
      if (Math.abs(z) > ODD && wide > 17) {
        svg.append(
            words(round(x + wide / 2), y + 14, fixed(z, 0), 'score', 'middle'));
      }
      spots.push({
        x: x + wide / 2,
        y: y + tall / 2,
        text: `${arm.item.label}, ${parameter.name}:\n` +
            `${
                  signed(quantity(
                      parameter.deviations[arm.index], parameter.unit))} ` +
            `against nominal, z = ${fixed(z, 1)}`
      });
    });
  });
  attachTips(svg, spots);
  return svg;
}

function fleetView(comparison) {
  const parameters = fleetParameters(comparison);
  const arms = fleetArms(comparison, parameters);
  const few =
      arms.length < 5 &&
      note(
          `${count(arms.length, 'arm')}: too few ` +
          'for statistics. Scores tell only which is farthest from the others, and ' +
          'a difference of less than a third of the median error is never called odd.');
  const odd = arms.filter((arm) => arm.odd);
  return {
    verdict: fleetVerdict(arms, comparison.failures),
    parts: [
      odd.length > 1 &&
          h('ul', {class: 'plain', id: 'odd-arms'},
            odd.slice(0, 8).map(
                (arm) =>
                    h('li', {}, h('strong', {}, arm.item.label),
                      ': ' + oddReasons(arm, arms).join('; ') + '.'))),
      fleetFigure(arms), few, fleetTable(comparison, arms),
      scoreMap(arms, parameters)
    ]
  };
}
