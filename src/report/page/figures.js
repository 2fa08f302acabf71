// Figures show their numbers under the pointer and by the arrow keys, and save
// themselves as files.

// A ring about the spot, and its text in a box that stays within the figure.
function tipShapes(spot, right) {
  const lines = spot.text.split('\n');
  const width = Math.max(...lines.map((line) => line.length)) * 7 + 14;
  const height = lines.length * 16 + 8;
  const x = Math.max(2, Math.min(spot.x + 8, right - width - 2));
  const y = spot.y > height + 8 ? spot.y - height - 8 : spot.y + 10;
  return [
    s('circle', {class: 'ring', cx: spot.x, cy: spot.y, r: 6}),
    s('rect', {class: 'tip-box', x, y, width, height, rx: 4}),
    ...lines.map((line, i) => s('text', {x: x + 7, y: y + 17 + i * 16}, line))
  ];
}

// The nearest spot shows its text, in place of what browsers show of titles.
function attachTips(svg) {
  const group = svg.querySelector('.tips');
  if (!group) return;
  const spots = [...group.children].map((circle) => ({
                                          x: circle.cx.baseVal.value,
                                          y: circle.cy.baseVal.value,
                                          text: circle.textContent
                                        }));
  const tip = s('g', {class: 'tip'});
  group.replaceWith(tip);
  let current = -1;
  const show = (index) => {
    current = index;
    tip.replaceChildren(...(
        index < 0 ? [] : tipShapes(spots[index], svg.viewBox.baseVal.width)));
  };
  svg.addEventListener('pointermove', (event) => {
    const area = svg.getBoundingClientRect();
    const factor = svg.viewBox.baseVal.width / area.width;
    const x = (event.clientX - area.left) * factor;
    const y = (event.clientY - area.top) * factor;
    let best = -1, nearest = 30 * 30;
    spots.forEach((spot, i) => {
      const distance = (spot.x - x) ** 2 + (spot.y - y) ** 2;
      if (distance < nearest) [best, nearest] = [i, distance];
    });
    if (best !== current) show(best);
  });
  svg.addEventListener('pointerleave', () => show(-1));
  svg.addEventListener('blur', () => show(-1));
  svg.addEventListener('keydown', (event) => {
    const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (!step) return;
    event.preventDefault();
    const from = current < 0 && step < 0 ? 0 : current;
    show((from + step + spots.length) % spots.length);
    svg.setAttribute('aria-label', spots[current].text);
  });
}

function saveSvg(title, svg) {
  const copy = svg.cloneNode(true);
  copy.setAttribute('xmlns', SVG);
  copy.setAttribute('width', svg.viewBox.baseVal.width);
  copy.setAttribute('height', svg.viewBox.baseVal.height);
  copy.prepend(
      s('title', {}, title),
      s('style', {}, document.getElementById('figure-style').textContent),
      s('rect', {class: 'paper', width: '100%', height: '100%'}));
  saveFile(
      fileName(title, '.svg'), 'image/svg+xml',
      new XMLSerializer().serializeToString(copy));
}

function addSaving(figure) {
  const title = figure.querySelector('h3').textContent;
  addTools(
      figure,
      tool(
          'Save SVG', `Save SVG of the figure "${title}"`,
          () => saveSvg(title, figure.querySelector('svg'))));
}

for (const figure of all('figure')) {
  attachTips(figure.querySelector('svg'));
  addSaving(figure);
}
