// The view of the arm turns, zooms and moves: the script draws the paths of the
// figure anew (arm_view_figure.cc), from the corners in the page's data.

const round = (v) => Math.round(v * 10) / 10;
const maxOf = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity);
const minOf = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
const norm = (v) => Math.hypot(...v);
const limit = (v, low, high) => Math.min(high, Math.max(low, v));

// As the figure is drawn at first.
const FRAME = {
  width: 480,
  height: 372,
  side: 30,
  top: 62,
  bottom: 34
};
const SHADES = 5;

const dots = (points, r) =>
    points
        .map(
            ([x, y]) => `M${round(x - r)},${y}a${r},${r} 0 1,0 ` +
                `${2 * r},0a${r},${r} 0 1,0 ${- 2 * r},0`)
        .join('');

// The smallest of 1, 2 or 5 times a power of ten that is not below.
function stepAbove(smallest) {
  const power = 10 ** Math.floor(Math.log10(smallest));
  return power *
      (1 >= smallest / power     ? 1 :
           2 >= smallest / power ? 2 :
           5 >= smallest / power ? 5 :
                                   10);
}

// The page's data and where they are looked at from.
function makeView(data, figure) {
  const view = {
    data,
    svg: figure.querySelector('svg'),
    pose: Number(figure.querySelector('[data-pose]')?.dataset.pose || 0),
    places: data.places.map(
        ([pose, at, before, after]) => ({pose, at, before, after})),
    cloud: data.cloud.map((point) => point.slice(0, 3)),
    parts: {}
  };
  view.points =
      [...view.places.map(({at}) => at), ...Object.values(data.lines).flat()];
  for (const part of all('[data-part]', view.svg)) {
    view.parts[part.dataset.part] = part;
  }
  resetView(view);
  return view;
}

function resetView(view) {
  Object.assign(view, {azimuth: -0.9, elevation: 0.35, zoom: 1, shift: [0, 0]});
}

const isShown = (part) => part && part.getAttribute('display') !== 'none';

// Screen coordinates (right, up) of a point of the base's frame.
function projection(view) {
  const [ca, sa] = [Math.cos(view.azimuth), Math.sin(view.azimuth)];
  const [ce, se] = [Math.cos(view.elevation), Math.sin(view.elevation)];
  return ([x, y, z]) => {
    const forward = ca * x + sa * y;
    return [-sa * x + ca * y, ce * z - se * forward];
  };
}

// All that is shown fits at a zoom of 1.
function place(view) {
  const project = projection(view);
  const points = isShown(view.parts.cloud) || view.points.length === 0 ?
      [...view.points, ...view.cloud] :
      view.points;
  const reach = maxOf(points.map(([x, y]) => norm([x, y])));
  const floor = Array.from(
      {length: 73},
      (unused, i) =>
          [reach * Math.cos(i * Math.PI / 36),
           reach * Math.sin(i * Math.PI / 36), 0]);
  const flat = [...points, ...floor].map(project);
  const low = [0, 1].map((k) => minOf(flat.map((point) => point[k])));
  const high = [0, 1].map((k) => maxOf(flat.map((point) => point[k])));
  const {width, height, side, top, bottom} = FRAME;
  const unit = view.zoom *
      Math.min(
          (width - 2 * side) / (high[0] - low[0] || 1),
          (height - top - bottom) / (high[1] - low[1] || 1));
  const middle = [width / 2, (top + height - bottom) / 2];
  const at = (point) => {
    const [x, y] = project(point);
    return [
      round(middle[0] + view.shift[0] + (x - (low[0] + high[0]) / 2) * unit),
      round(middle[1] + view.shift[1] - (y - (low[1] + high[1]) / 2) * unit)
    ];
  };
  return {at, unit, middle, floor};
}

// The paths of the layers by their names.
function layersOf(view, {at, unit, floor}) {
  const {data, places, cloud} = view;
  const arm = (data.lines[view.pose] || []).map(at);
  const layers = {
    floor: 'M' + floor.map(at).join('L'),
    arm: arm.length ? 'M' + arm.join('L') : '',
    joints: dots(arm.slice(0, -1), 4),
    places:
        dots(places.map((item) => at(item.at)), places.length > 150 ? 1 : 1.8)
  };
  const shaded = (name, shades, path) => {
    for (let k = 0; k < SHADES; ++k) layers[`${name}-${k}`] = '';
    shades.forEach((shade, i) => layers[`${name}-${shade}`] += path(i));
  };
  for (const state of ['before', 'after']) {
    const factor = data.factors[state];
    shaded(state, data.shades[state], (i) => {
      const end = places[i].at.map((v, k) => v + factor * places[i][state][k]);
      return `M${at(places[i].at)}L${at(end)}`;
    });
  }
  shaded('cloud', data.shades.cloud, (i) => `M${at(cloud[i])}h0`);
  const size = 34 / unit;
  const tips =
      [0, 1, 2].map((k) => at([0, 1, 2].map((j) => j === k ? size : 0)));
  layers.axes = tips.map((tip) => `M${at([0, 0, 0])}L${tip}`).join('');
  all('text', view.parts.triad).forEach((text, k) => {
    text.setAttribute('x', round(tips[k][0] + 3));
    text.setAttribute('y', round(tips[k][1] + 3));
  });
  return layers;
}

// Triangles that face the reader, the farthest first.
function drawShapes(view, {at}) {
  const part = view.parts.shapes;
  if (!isShown(part)) return;
  const [ca, sa] = [Math.cos(view.azimuth), Math.sin(view.azimuth)];
  const [ce, se] = [Math.cos(view.elevation), Math.sin(view.elevation)];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const reader = [ce * ca, ce * sa, se];
  const facets = [];
  for (const shape of view.data.shapes) {
    const [x, y, z, origin] = view.data.frames[view.pose][shape.frame];
    const points = shape.vertices.map(
        (v) =>
            [dot(x, v) + origin[0], dot(y, v) + origin[1],
             dot(z, v) + origin[2]]);
    const flat = points.map(at);
    for (const [a, b, c] of shape.triangles) {
      const [p, q] = [b, c].map(
          (corner) => points[corner].map((v, k) => v - points[a][k]));
      const normal = [
        p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
        p[0] * q[1] - p[1] * q[0]
      ];
      const facing = dot(normal, reader) / norm(normal);
      if (!(facing > 0)) continue;
      facets.push({
        depth: dot(points[a], reader) + dot(points[b], reader) +
            dot(points[c], reader),
        shade: Math.min(SHADES - 1, Math.floor(SHADES * facing)),
        path: `M${flat[a]}L${flat[b]}L${flat[c]}z`
      });
    }
  }
  facets.sort((a, b) => a.depth - b.depth);
  const paths = [];
  for (const {shade, path} of facets) {
    const last = paths[paths.length - 1];
    if (last && last.shade === shade) {
      last.d += path;
    } else {
      paths.push({shade, d: path});
    }
  }
  part.replaceChildren(...paths.map(
      ({shade, d}) => s('path', {class: `shape facet${shade}`, d})));
}

function drawScale(view, unit) {
  const length = stepAbove(24 / unit);
  const end = 12 + length * unit;
  const [path, text] = view.parts.scale.children;
  path.setAttribute('d', `M12,${FRAME.height - 10}H${round(end)}`);
  text.setAttribute('x', round(end + 6));
  text.textContent = `${Number(length.toPrecision(3))} mm`;
}

function drawView(view) {
  const placed = place(view);
  const layers = layersOf(view, placed);
  for (const path of all('[data-layer]', view.svg)) {
    const d = layers[path.dataset.layer];
    if (d !== undefined) path.setAttribute('d', d);
  }
  drawShapes(view, placed);
  drawScale(view, placed.unit);
}

// By `factor` about a point of the figure, which stays where it is.
function zoomBy(view, factor, about) {
  const {middle} = place(view);
  const before = view.zoom;
  view.zoom = limit(before * factor, 0.5, 50);
  const ratio = view.zoom / before;
  about = about || middle;
  view.shift = view.shift.map((shift, k) => {
    const from = about[k] - middle[k];
    return from - (from - shift) * ratio;
  });
  drawView(view);
}

function turnBy(view, dx, dy) {
  view.azimuth += dx;
  view.elevation = limit(view.elevation + dy, -1.57, 1.57);
  drawView(view);
}

function shiftBy(view, dx, dy) {
  view.shift = [view.shift[0] + dx, view.shift[1] + dy];
  drawView(view);
}

// Where an event is in the figure's own units.
function figurePoint(svg, event) {
  const area = svg.getBoundingClientRect();
  const factor = FRAME.width / area.width;
  return [
    (event.clientX - area.left) * factor, (event.clientY - area.top) * factor
  ];
}

// One pointer turns (with Shift or another button: moves), two zoom and move.
function followPointers(view) {
  const {svg} = view;
  const pointers = new Map();
  const centreOf = (points) => [0, 1].map(
      (k) => points.reduce((sum, point) => sum + point[k], 0) / points.length);
  const spread = ([a, b]) => norm([a[0] - b[0], a[1] - b[1]]) || 1;
  svg.addEventListener('pointerdown', (event) => {
    svg.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, figurePoint(svg, event));
  });
  svg.addEventListener('pointermove', (event) => {
    if (!pointers.has(event.pointerId)) return;
    const before = [...pointers.values()];
    pointers.set(event.pointerId, figurePoint(svg, event));
    const after = [...pointers.values()];
    const [from, to] = [centreOf(before), centreOf(after)];
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    if (after.length === 2) {
      shiftBy(view, dx, dy);
      zoomBy(view, spread(after) / spread(before), to);
    } else if (event.shiftKey || event.buttons > 1) {
      shiftBy(view, dx, dy);
    } else {
      turnBy(view, -dx * 0.01, dy * 0.01);
    }
  });
  for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) {
    svg.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  svg.addEventListener('contextmenu', (event) => event.preventDefault());
}

// Without a click before it, the wheel is the page's.
function followWheel(view) {
  const {svg} = view;
  svg.addEventListener('wheel', (event) => {
    if (document.activeElement !== svg && !event.ctrlKey) return;
    event.preventDefault();
    zoomBy(
        view, Math.exp(-limit(event.deltaY, -200, 200) / 400),
        figurePoint(svg, event));
  }, {passive: false});
}

function followKeys(view) {
  view.svg.addEventListener('keydown', (event) => {
    const way = {
      ArrowLeft: [1, 0],
      ArrowRight: [-1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1]
    }[event.key];
    if (way) {
      event.preventDefault();
      if (event.shiftKey) {
        shiftBy(view, -20 * way[0], -20 * way[1]);
      } else {
        turnBy(view, 0.15 * way[0], 0.1 * way[1]);
      }
    } else if (event.key === '+' || event.key === '=') {
      zoomBy(view, 1.25);
    } else if (event.key === '-') {
      zoomBy(view, 0.8);
    } else if (event.key === '0') {
      resetView(view);
      drawView(view);
    }
  });
}

// Buttons that show and hide what there is.
function partButtons(view) {
  const button = (name, label) => {
    const part = view.parts[name];
    if (!part) return [];
    return h(
        'button', {
          type: 'button',
          'aria-pressed': String(isShown(part)),
          onclick: (event) => {
            const hide = isShown(part);
            for (const each of [part, view.parts[name + '-key']]) {
              if (hide) {
                each?.setAttribute('display', 'none');
              } else {
                each?.removeAttribute('display');
              }
            }
            event.target.setAttribute('aria-pressed', String(!hide));
            drawView(view);
          }
        },
        label);
  };
  return [
    button('before', 'errors before'), button('after', 'errors after'),
    button('cloud', 'predicted accuracy'), button('shapes', 'shape')
  ];
}

function zoomButtons(view) {
  const button = (text, label, onclick) =>
      h('button', {type: 'button', 'aria-label': label, onclick}, text);
  return [
    button('+', 'zoom in', () => zoomBy(view, 1.25)),
    button('−', 'zoom out', () => zoomBy(view, 0.8)),
    button(
        'reset', 'reset the view',
        () => {
          resetView(view);
          drawView(view);
        })
  ];
}

// Which pose the arm is drawn at, and what is said of it.
function poseSlider(view) {
  const poses = Object.keys(view.data.lines).map(Number);
  if (poses.length < 2) return [];
  document.querySelector('#arm [data-pose]')?.remove();
  const said = h('output', {class: 'small'});
  const say = () => {
    const note = view.data.notes[view.pose];
    said.textContent = `pose ${view.pose}` + (note ? ': ' + note : '');
  };
  say();
  const slider = h('input', {
    type: 'range',
    min: 0,
    max: poses.length - 1,
    value: poses.indexOf(view.pose),
    'aria-label': 'pose at which the arm is drawn',
    oninput: (event) => {
      view.pose = poses[event.target.value];
      say();
      drawView(view);
    }
  });
  return [h('label', {}, 'Arm at pose ', slider), said];
}

const armData = document.getElementById('arm-data');
if (armData) {
  const figure = document.getElementById('arm');
  const view = makeView(JSON.parse(armData.textContent), figure);
  figure.querySelector('.drawing')
      .before(
          h('div', {class: 'controls'}, partButtons(view), zoomButtons(view),
            poseSlider(view)));
  figure.querySelector('figcaption')
      .append(
          ' Drag or use the arrow keys to turn, Shift with them to move, ' +
          'plus and minus, two fingers or, after a click, the wheel to zoom, ' +
          '0 for the first view.');
  followPointers(view);
  followWheel(view);
  followKeys(view);
}
document.documentElement.dataset.ready = 'true';
