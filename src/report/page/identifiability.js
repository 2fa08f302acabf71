// What these poses identify: singular values, ranks, linear dependences.

const DEPENDENCE = {
  no_effect: 'no effect',
  structural: 'at all poses',
  at_geometry: 'at the nominal geometry',
  not_excited: 'at these poses'
};

function singularValueFigure(report, title) {
  const values = report.singular_values;
  if (!values || values.length === 0) return null;
  const rank = report.rank;
  const layer = (kept) => ({
    type: 'points',
    marker: kept ? 'circle' : 'triangle',
    className: kept ? 'c2' : 'c1',
    size: 4,
    label: kept ? 'identifiable' : 'unidentifiable',
    x: values.map((v, i) => i + 1),
    y: values.map((v, i) => (i < rank) === kept ? Math.max(v, 1e-18) : NaN),
    tip: (i) => `${i + 1} of ${values.length}: ${num(values[i])}`
  });
  const layers = [layer(true)];
  if (rank < values.length) layers.push(layer(false));
  const smallest = values[Math.max(rank - 1, 0)];
  return figure({
    id: 'singular-values',
    title,
    draw: (width) => plot(width, {
      x: {
        label: 'direction, best identifiable first',
        integer: true,
        min: 0,
        max: values.length + 1
      },
      y: {label: 'singular value, relative', log: true},
      layers,
      description: `${values.length} singular values from 1 to ` +
          `${num(minOf(values))}; ${rank} count`
    }),
    note:
        `Each direction in which the parameters can move, and how much these ` +
        `poses see of it. The weakest that counts is ${
            num(smallest)} of the best` +
        (rank < values.length ?
             `; ${count(values.length - rank, 'direction')} ` +
                 'below it cannot be determined at these poses.' :
             '.')
  });
}

function rankTable(identifiability) {
  const rows =
      [
        ['all candidates, any poses', 'perturbed', 'structural_rank'],
        ['all candidates, any poses', 'nominal', 'generic_rank'],
        ['estimated ones, these poses', 'perturbed', 'perturbed_rank'],
        ['estimated ones, these poses', 'nominal', 'nominal_rank']
      ].map(([what, geometry, key]) => [what, geometry, identifiability[key]])
          .filter(([, , report]) => report && report.rank > 0);
  const outOf = (what) =>
      (what.startsWith('all') ? identifiability.num_candidates :
                                identifiability.num_free);
  return table({
    id: 'ranks',
    caption: 'Numerical rank',
    columns: [
      {title: 'of what'}, {
        title: 'geometry',
        help: 'perturbed: near the nominal ' +
            'one, where effects of second order count too'
      },
      {title: 'rank', align: 'right'}, {title: 'of', align: 'right'}, {
        title: 'gap',
        align: 'right',
        help: 'smallest singular value that counts ' +
            'over the largest that does not'
      }
    ],
    rows: rows.map(([what, geometry, report]) => ({
                     cells: [
                       what, geometry, cell(String(report.rank), report.rank),
                       cell(String(outOf(what)), outOf(what)),
                       report.gap === null ? cell('full rank', null) :
                                             numberCell(report.gap, 2)
                     ]
                   }))
  });
}

function relationTable(relations) {
  if (relations.length === 0) return null;
  return table({
    id: 'relations',
    caption: 'Linearly dependent parameters, left out',
    columns: [
      {title: 'parameter'}, {title: 'relation', align: 'why'},
      {title: 'dependent'}, {title: 'checked'}
    ],
    rows: relations.map((relation) => ({
                          cells: [
                            relation.parameter, relation.text,
                            DEPENDENCE[relation.level] || relation.level,
                            relation.verified ? 'yes' : 'no'
                          ]
                        }))
  });
}

function identifiabilitySection(entry) {
  const found = entry.result.identifiability;
  const method = found.method === 'rules' ?
      'by the three rules of the published study' :
      'by ranks';
  const free = found.num_free;
  return section(
      'identifiability', 'Identifiability',
      p(`${count(free, 'parameter')} ${
            free === 1 ? 'was' : 'were'} estimated, ` +
        `chosen ${method}.`),
      findingText(entry.result, /^rank$/),
      h('div', {class: 'pair'},
        singularValueFigure(
            found.nominal_rank, 'Singular values of the estimated parameters'),
        h('div', {}, rankTable(found), observabilityNote(found))),
      relationTable(found.relations),
      found.advice.length > 0 &&
          h('div', {}, h('h3', {}, 'Motions that would help'),
            h('ul', {}, found.advice.map((text) => h('li', {}, text)))));
}

function observabilityNote(found) {
  const o = found.observability && found.observability.scaled;
  if (!o || !isNumber(o.o1) || o.o1 === 0) return null;
  return note(
      `Observability indices, angles scaled by the reach: O1 ${num(o.o1)}, ` +
      `O2 ${num(o.o2)}, O3 ${num(o.o3)}, O4 ${num(o.o4)}, O5 ${num(o.o5)}; ` +
      `condition ${num(o.condition)}.`);
}
