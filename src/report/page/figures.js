// Figures: SVG drawn at the width there is, so that letters keep their size
// from the phone to paper. A figure tells its numbers under the pointer and by
// the arrow keys, and saves itself as a file.

const figureStyle = document.getElementById('page-style')
                        .textContent.split('/* figures */')[1]
                        .split('/* end of figures */')[0];

// {id, title, note, controls, draw: (width) => svg}. Redrawn when its width
// changes, and by `redraw`.
function figure(spec) {
  const holder = h('div', {class: 'drawing'});
  let drawn = 640;
  const draw = () => holder.replaceChildren(spec.draw(drawn));
  const save =
      h('button', {
        type: 'button',
        class: 'tool',
        'aria-label': 'Save the figure "' + spec.title + '" as SVG',
        onclick: () => saveSvg(spec, holder.querySelector('svg'))
      },
        'Save SVG');
  draw();
  new ResizeObserver((entries) => {
    const width = Math.round(entries[0].contentRect.width);
    if (width < 40 || Math.abs(width - drawn) < 2) return;
    drawn = width;
    draw();
  }).observe(holder);
  const element =
      h('figure', {id: spec.id, class: spec.className},
        h('div', {class: 'table-head'}, h('h3', {}, spec.title),
          h('span', {class: 'tools'}, save)),
        spec.controls, holder, spec.note && h('figcaption', {}, spec.note));
  element.redraw = draw;
  return element;
}

// A slider from 0 to `most`.
const slider = (label, most, value, change) => h('input', {
  type: 'range',
  min: 0,
  max: most,
  value,
  'aria-label': label,
  oninput: (event) => change(Number(event.target.value))
});

function saveSvg(spec, svg) {
  const copy = svg.cloneNode(true);
  copy.setAttribute('xmlns', SVG);
  copy.setAttribute('width', svg.viewBox.baseVal.width);
  copy.setAttribute('height', svg.viewBox.baseVal.height);
  copy.prepend(
      s('title', {}, spec.title), s('style', {}, figureStyle),
      s('rect', {class: 'paper', width: '100%', height: '100%'}));
  saveFile(
      fileName(spec.title, '.svg'), 'image/svg+xml',
      new XMLSerializer().serializeToString(copy));
}

const canvas = (width, height, label) => s('svg', {
  class: 'chart',
  viewBox: `0 0 ${width} ${height}`,
  role: 'img',
  'aria-label': label,
  tabindex: '0',
});

const words = (x, y, text, className, anchor) =>
    s('text', {x, y, class: className, 'text-anchor': anchor}, text);

const round = (v) => Math.round(v * 100) / 100;

// One path for all marks of a layer: thousands of elements would be slow.
const MARKS = {
  circle: (x, y, r) => `M${round(x - r)},${round(y)}a${r},${r} 0 1,0 ` +
      `${2 * r},0a${r},${r} 0 1,0 ${- 2 * r},0`,
  square: (x, y, r) =>
      `M${round(x - r)},${round(y - r)}h${2 * r}v${2 * r}h${- 2 * r}z`,
  triangle: (x, y, r) =>
      `M${round(x)},${round(y - 1.2 * r)}l${1.2 * r},${2 * r}h${- 2.4 * r}z`,
};
const marksPath = (points, mark, r) =>
    points.map(([x, y]) => MARKS[mark](x, y, r)).join('');

// Frame, ticks and labels; {spec, x, y, svg, box}.
function frame(width, spec) {
  const height = spec.height || Math.round(Math.min(340, 150 + width * 0.28));
  const legend = legendOf(spec);
  const box = {
    left: 62,
    right: width - 14,
    top: legend.length > 0 ? 34 : 14,
    bottom: height - 46
  };
  const svg = canvas(width, height, spec.description);
  const all = (key) => spec.layers.flatMap(
      (layer) =>
          [...(layer[key] || []), ...(layer[key + '0'] || []),
           ...(layer[key + '1'] || [])]);
  const x = scale({...spec.x}, all('x'), box.left, box.right);
  const y = scale(
      {...spec.y, vertical: true},
      [...all('y'), ...(spec.hlines || []).map((line) => line.y)], box.bottom,
      box.top);
  const grid = [];
  for (const tick of y.ticks) {
    grid.push(
        s('line', {
          class: 'grid',
          x1: box.left,
          x2: box.right,
          y1: round(y.at(tick.value)),
          y2: round(y.at(tick.value))
        }),
        words(
            box.left - 6, round(y.at(tick.value)) + 4, tick.text, 'tick',
            'end'));
  }
  for (const tick of x.ticks) {
    const at = round(x.at(tick.value));
    grid.push(
        s('line',
          {class: 'axis', x1: at, x2: at, y1: box.bottom, y2: box.bottom + 4}),
        words(at, box.bottom + 18, tick.text, 'tick', 'middle'));
  }
  svg.append(s(
      'g', {'aria-hidden': 'true'}, grid, s('line', {
        class: 'axis',
        x1: box.left,
        x2: box.right,
        y1: box.bottom,
        y2: box.bottom
      }),
      words((box.left + box.right) / 2, height - 8, x.label, 'label', 'middle'),
      s('text', {
        class: 'label',
        'text-anchor': 'middle',
        transform: `translate(13 ${(box.top + box.bottom) / 2}) rotate(-90)`
      },
        y.label)));
  drawLegend(svg, legend, box);
  return {svg, x, y, box, width, height};
}

const legendOf = (spec) => spec.layers.filter((layer) => layer.label);

function drawLegend(svg, legend, box) {
  let x = box.left;
  for (const layer of legend) {
    const mark = layer.marker || (layer.type === 'bars' ? 'square' : null);
    if (layer.type === 'line') {
      svg.append(s('line', {
        class: 'line ' + layer.className,
        x1: x,
        x2: x + 18,
        y1: 14,
        y2: 14
      }));
    }
    if (mark) {
      svg.append(
          s('path',
            {class: 'mark ' + layer.className, d: MARKS[mark](x + 9, 14, 4)}));
    }
    svg.append(words(x + 24, 18, layer.label, 'legend', 'start'));
    x += 24 + layer.label.length * 6.4 + 20;
  }
}

// A chart of layers {type: line | points | stems | bars, x, y (bars: x0, x1,
// y), className, marker, label, tip: (i) => text} with `hlines`.
function plot(width, spec) {
  const f = frame(width, spec);
  const spots = [];
  for (const line of spec.hlines || []) {
    const at = round(f.y.at(line.y));
    f.svg.append(
        s('line', {
          class: 'reference',
          x1: f.box.left,
          x2: f.box.right,
          y1: at,
          y2: at
        }),
        words(f.box.right - 4, at - 5, line.label, 'reference-label', 'end'));
  }
  for (const layer of spec.layers) drawLayer(f, layer, spec, spots);
  attachTips(f.svg, spots);
  return f.svg;
}

function drawLayer(f, layer, spec, spots) {
  const usable = (v, axis) => isNumber(v) && (!axis.log || v > 0);
  const points = [];
  layer.y.forEach((value, i) => {
    const at =
        layer.type === 'bars' ? (layer.x0[i] + layer.x1[i]) / 2 : layer.x[i];
    if (!usable(value, spec.y) || !usable(at, spec.x)) return;
    const point = [f.x.at(at), f.y.at(value), i];
    points.push(point);
    if (layer.tip) spots.push({x: point[0], y: point[1], text: layer.tip(i)});
  });
  const bottom = f.y.at(spec.y.log ? f.y.low : Math.max(0, f.y.low));
  if (layer.type === 'bars') {
    f.svg.append(s('path', {
      class: 'bar ' + layer.className,
      d: points
             .map(([, y, i]) => {
               const [a, b] = [f.x.at(layer.x0[i]), f.x.at(layer.x1[i])];
               return `M${round(a + 0.5)},${round(bottom)}V${round(y)}H${
                   round(b - 0.5)}V${round(bottom)}z`;
             })
             .join('')
    }));
  }
  if (layer.type === 'stems') {
    f.svg.append(s('path', {
      class: 'stem ' + layer.className,
      d: points.map(([x, y]) => `M${round(x)},${round(bottom)}V${round(y)}`)
             .join('')
    }));
  }
  if (layer.type === 'line') {
    f.svg.append(s('path', {
      class: 'line ' + layer.className,
      d: points
             .map(
                 ([x, y], k) => `${k === 0 ? 'M' : 'L'}${round(x)},${round(y)}`)
             .join('')
    }));
  }
  if (layer.marker && points.length <= 6000) {
    const size = layer.size || (points.length > 400 ? 1.5 : 3.5);
    f.svg.append(s('path', {
      class: 'mark ' + layer.className,
      d: marksPath(points, layer.marker, size)
    }));
  }
}

// The nearest of `spots` tells its text: under the pointer, or stepped through
// by the arrow keys.
function attachTips(svg, spots) {
  if (spots.length === 0) return;
  const tip = s('g', {class: 'tip', visibility: 'hidden'});
  svg.append(tip);
  let current = -1;
  const hide = () => {
    current = -1;
    tip.setAttribute('visibility', 'hidden');
  };
  const show = (index) => {
    current = index;
    tip.replaceChildren(...tipShapes(spots[index], svg.viewBox.baseVal.width));
    tip.setAttribute('visibility', 'visible');
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
    if (best < 0) {
      hide();
    } else if (best !== current) {
      show(best);
    }
  });
  svg.addEventListener('pointerleave', hide);
  svg.addEventListener('blur', hide);
  svg.addEventListener('keydown', (event) => {
    const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (!step) return;
    event.preventDefault();
    const from = current < 0 && step < 0 ? 0 : current;
    show((from + step + spots.length) % spots.length);
    svg.setAttribute('aria-label', spots[current].text);
  });
}

// A ring about the spot, and its text in a box that stays within the figure.
function tipShapes(spot, right) {
  const lines = spot.text.split('\n');
  const width = maxOf(lines.map((line) => line.length)) * 6.3 + 14;
  const height = lines.length * 15 + 8;
  const x = round(Math.max(2, Math.min(spot.x + 8, right - width - 2)));
  const y = round(spot.y > height + 8 ? spot.y - height - 8 : spot.y + 10);
  return [
    s('circle', {class: 'ring', cx: round(spot.x), cy: round(spot.y), r: 6}),
    s('rect', {class: 'tip-box', x, y, width: round(width), height, rx: 4}),
    ...lines.map(
        (line, i) => words(x + 7, y + 16 + i * 15, line, 'tip-text', 'start'))
  ];
}
