// What kind of page this is, and its parts in order.

function resultPage(entry) {
  const {result} = entry;
  document.title = result.title + ' – Alidade';
  const parts = [
    ...document.getElementById('sections').content.children,
    ...[parametersSection, identifiabilitySection, residualsSection,
        workspaceSection, stagesSection, solverSection, provenanceSection]
        .map((part) => part(entry))
        .filter(Boolean)
  ];
  return [
    h('header', {}, h('h1', {}, result.title),
      h('div', {class: 'small'}, result.arm)),
    firstScreen(entry), contents(parts), parts, footer(result.version)
  ];
}

function contents(sections) {
  return h(
      'nav', {'aria-label': 'Contents'},
      h('ul', {},
        sections.map(
            (part) =>
                h('li', {},
                  h('a', {href: '#' + part.id},
                    part.querySelector('h2').textContent)))));
}

const footer = (version) => h(
    'footer', {},
    `Alidade ${version}. Lengths in mm, ` +
        'angles in degrees where nothing else is said. An error is the distance ' +
        'between where the arm believes its target to be and where it was measured.');

document.getElementById('content').append(
    ...(data.page === 'comparison' ? comparisonPage(data.comparison) :
                                     resultPage(data.results[0]))
        .flat(Infinity));
document.documentElement.setAttribute('data-ready', 'true');
