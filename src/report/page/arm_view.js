// The arm where it stood, the places that were measured, and how far off it was
// at each: an orthographic view that turns by pointer and by the arrow keys.

const round = (v) => Math.round(v * 10) / 10;
const norm = (v) => Math.hypot(...v);
const superscript =
    (digits) => [...digits]
                    .map((c) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)])
                    .join('');
const num = (v) => String(Number(v.toPrecision(3)))
                       .replace(/e(.*)/, (e, n) => '×10' + superscript(n));
const maxOf = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity);
const minOf = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);

const words = (x, y, text, className) =>
    s('text', {x, y, class: className}, text);

const dots = (points, r) =>
    points
        .map(
            ([x, y]) => `M${x - r},${y}a${r},${r} 0 1,0 ` +
                `${2 * r},0a${r},${r} 0 1,0 ${- 2 * r},0`)
        .join('');

// 1, 2 or 5 times a power of ten.
function niceFactor(rough) {
  if (!(rough > 1) || !isFinite(rough)) return 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * (rough / power >= 5 ? 5 : rough / power >= 2 ? 2 : 1);
}

// {lines, places} of the page's data as a view that can be drawn.
function makeView({lines, places}) {
  const view = {
    azimuth: -0.9,
    elevation: 0.35,
    before: true,
    after: true,
    poses: Object.keys(lines).map(Number),
    lines,
    places:
        places.map(([pose, at, before, after]) => ({pose, at, before, after}))
  };
  view.points =
      [...view.places.map((place) => place.at), ...Object.values(lines).flat()];
  const sides = [0, 1, 2].map((k) => view.points.map((point) => point[k]));
  view.centre = sides.map((side) => (minOf(side) + maxOf(side)) / 2);
  const size = maxOf(sides.map((side) => maxOf(side) - minOf(side))) || 1;
  view.factor = niceFactor(
      size * 0.1 /
      (maxOf(view.places.map((place) => norm(place.before))) || 1));
  // The pose that is drawn first: where the arm was farthest off.
  const error = (pose) => {
    const place = view.places.find((item) => item.pose === pose);
    return place ? norm(place.before) : 0;
  };
  const errors = view.poses.map(error);
  view.pose = view.poses[Math.max(errors.indexOf(maxOf(errors)), 0)];
  return view;
}

function poseText(view) {
  const place = view.places.find((item) => item.pose === view.pose);
  if (view.poses.length === 0) return '';
  return `pose ${view.pose}` +
      (place ? `: ${num(norm(place.before))} mm before, ` +
               `${num(norm(place.after))} mm after` :
               '');
}

function armFigure(view) {
  const svg = s('svg', {
    class: 'chart',
    viewBox: '0 0 480 346',
    role: 'img',
    tabindex: '0',
    'aria-label': 'The arm as a chain of links, ' +
        `${view.places.length} measured places, and the position errors ` +
        'before and after calibration as lines'
  });
  const draw = () => svg.replaceChildren(...armShapes(view, 480, 346));
  const said = h('output', {class: 'small'}, poseText(view));
  const toggle = (key) =>
      h('button', {
        type: 'button',
        'aria-pressed': 'true',
        onclick: (event) => {
          view[key] = !view[key];
          event.target.setAttribute('aria-pressed', String(view[key]));
          draw();
        }
      },
        'errors ' + key);
  const pose = h('input', {
    type: 'range',
    min: 0,
    max: view.poses.length - 1,
    value: view.poses.indexOf(view.pose),
    'aria-label': 'pose at which the arm is drawn',
    oninput: (event) => {
      view.pose = view.poses[event.target.value];
      said.textContent = poseText(view);
      draw();
    }
  });
  draw();
  turnable(svg, view, draw);
  return h(
      'figure', {},
      h('div', {class: 'table-head'},
        h('h3', {}, 'The arm and its errors where it was measured')),
      h('div', {class: 'controls'}, toggle('before'), toggle('after'),
        view.poses.length > 1 ? h('label', {}, 'Arm at pose ', pose) : [],
        said),
      h('div', {class: 'drawing'}, svg),
      h('figcaption', {},
        `Errors are drawn ${view.factor} times as long as they are, from the ` +
            'measured point towards where the arm believed to be. Drag, or ' +
            'use the arrow keys, to turn the view.'));
}

function turnable(svg, view, redraw) {
  const turn = (dx, dy) => {
    view.azimuth += dx;
    view.elevation = Math.max(-1.57, Math.min(1.57, view.elevation + dy));
    redraw();
  };
  svg.addEventListener('pointerdown', (event) => {
    svg.setPointerCapture(event.pointerId);
    let [x, y] = [event.clientX, event.clientY];
    const move = (next) => {
      turn((x - next.clientX) * 0.01, (next.clientY - y) * 0.01);
      [x, y] = [next.clientX, next.clientY];
    };
    svg.addEventListener('pointermove', move);
    svg.addEventListener(
        'pointerup', () => svg.removeEventListener('pointermove', move),
        {once: true});
  });
  svg.addEventListener('keydown', (event) => {
    const step = {
      ArrowLeft: [0.15, 0],
      ArrowRight: [-0.15, 0],
      ArrowUp: [0, 0.1],
      ArrowDown: [0, -0.1]
    }[event.key];
    if (!step) return;
    event.preventDefault();
    turn(...step);
  });
}

// Screen coordinates (right, up) and depth of a point of the base's frame.
function projection(view) {
  const [ca, sa] = [Math.cos(view.azimuth), Math.sin(view.azimuth)];
  const [ce, se] = [Math.cos(view.elevation), Math.sin(view.elevation)];
  return (point) => {
    const [x, y, z] = point.map((v, k) => v - view.centre[k]);
    const forward = ca * x + sa * y;
    return [-sa * x + ca * y, ce * z - se * forward, se * z + ce * forward];
  };
}

function armShapes(view, width, height) {
  const project = projection(view);
  const flat = view.points.map(project);
  const low = [0, 1].map((k) => minOf(flat.map((point) => point[k])));
  const high = [0, 1].map((k) => maxOf(flat.map((point) => point[k])));
  const unit = Math.min(
      (width - 60) / (high[0] - low[0] || 1),
      (height - 70) / (high[1] - low[1] || 1));
  const at = (point) => {
    const [x, y] = project(point);
    return [
      round(width / 2 + (x - (low[0] + high[0]) / 2) * unit),
      round(height / 2 + 6 - (y - (low[1] + high[1]) / 2) * unit)
    ];
  };
  return [
    floorCircle(view, at), armLinks(view.lines[view.pose] || [], at),
    errorVectors(view, at), axesTriad(view, at, unit),
    viewLegend(view, unit, height)
  ].flat();
}

// A circle about the base shows which way is up and how far it reaches.
function floorCircle(view, at) {
  const radius = maxOf(view.points.map((v) => Math.hypot(v[0], v[1])));
  const ring = Array.from({length: 73}, (unused, i) => at([
                                          radius * Math.cos(i * Math.PI / 36),
                                          radius * Math.sin(i * Math.PI / 36), 0
                                        ]));
  return s('path', {class: 'link ghost', d: 'M' + ring.join('L')});
}

function armLinks(arm, at) {
  if (arm.length === 0) return s('g', {});
  const corners = arm.map(at);
  return s(
      'g', {}, s('path', {class: 'link', d: 'M' + corners.join('L')}),
      s('path', {class: 'joint', d: dots(corners.slice(0, -1), 4)}));
}

function errorVectors(view, at) {
  const shapes = [];
  const ends = (key) => view.places.map(
      (place) => at(place.at.map((v, k) => v + view.factor * place[key][k])));
  const starts = view.places.map((place) => at(place.at));
  for (const [key, className] of [['before', 's2'], ['after', 's1']]) {
    if (!view[key]) continue;
    const tips = ends(key);
    shapes.push(s('path', {
      class: 'vector ' + className,
      d: starts.map((start, i) => `M${start}L${tips[i]}`).join('')
    }));
  }
  shapes.push(s('path', {
    class: view.after ? 'place s1' : 'place',
    d: dots(starts, view.places.length > 150 ? 1.5 : 2.4)
  }));
  return shapes;
}

function axesTriad(view, at, unit) {
  const size = 34 / unit;
  const origin = at([0, 0, 0]);
  return s('g', {}, ['x', 'y', 'z'].map((name, k) => {
    const tip = at([0, 1, 2].map((j) => (j === k ? size : 0)));
    return [
      s('line',
        {class: 'axis', x1: origin[0], y1: origin[1], x2: tip[0], y2: tip[1]}),
      words(tip[0] + 3, tip[1] + 3, name, 'tick')
    ];
  }));
}

// What the lines are, and how long 1 mm of error and 100 mm of arm are drawn.
function viewLegend(view, unit, height) {
  const error = niceFactor(60 / (unit * view.factor) * 1000) / 1000;
  const arm = niceFactor(60 / unit);
  const scaleBar = (y, size, text, className) =>
      [s('path', {class: className, d: `M12,${y}h${round(size)}`}),
       words(12 + size + 6, y + 4, text, 'tick')];
  return s(
      'g', {}, s('path', {class: 'vector s2', d: 'M12,12h18'}),
      words(36, 16, 'error before', 'tick'),
      s('path', {class: 'place s1', d: dots([[134, 12]], 2.4)}),
      s('path', {class: 'vector s1', d: 'M134,12h14'}),
      words(155, 16, 'measured point, error after', 'tick'),
      scaleBar(
          height - 26, error * unit * view.factor, num(error) + ' mm of error',
          'vector s2'),
      scaleBar(height - 10, arm * unit, num(arm) + ' mm', 'axis'));
}

const armData = document.getElementById('arm-data');
if (armData) {
  const figure = armFigure(makeView(JSON.parse(armData.textContent)));
  document.getElementById('arm').replaceChildren(figure);
  addSaving(figure);
}
document.documentElement.dataset.ready = 'true';
