// The arm where it stood, the places that were measured, and how far off it was
// at each: an orthographic view that turns by pointer and by the arrow keys.

// Measured places and errors of a table of observations, in mm and in the
// frame of the arm's base; those without a whole position are left out.
function measuredPlaces(columns, frame) {
  const places = [];
  const vector = (prefix, i, ends) =>
      ends.map((end) => columns[prefix + end][i]);
  const errorEnds = ['_dx_mm', '_dy_mm', '_dz_mm'];
  (columns.x_mm || []).forEach((x, i) => {
    const at = [x, columns.y_mm[i], columns.z_mm[i]];
    const before = vector('before', i, errorEnds);
    const after = vector('after', i, errorEnds);
    if (![...at, ...before, ...after].every(isNumber)) return;
    places.push({
      pose: columns.pose[i],
      at: frame.point(at),
      before: frame.direction(before),
      after: frame.direction(after),
      errorBefore: columns.before_error_mm[i],
      errorAfter: columns.after_error_mm[i]
    });
  });
  return places;
}

// From the instrument's frame, in which all is measured, into the base's.
function baseFrame(picture) {
  if (!picture) return {point: (v) => v, direction: (v) => v};
  const rows = picture.instrument_from_base;
  const direction = (v) => [0, 1, 2].map(
      (k) => rows[0][k] * v[0] + rows[1][k] * v[1] + rows[2][k] * v[2]);
  return {direction, point: (v) => direction(v.map((x, k) => x - rows[k][3]))};
}

function armView(entry) {
  const table = entry.tables.residuals;
  if (!table) return null;
  const frame = baseFrame(entry.picture);
  const places = measuredPlaces(table.columns, frame);
  const lines = entry.picture ?
      entry.picture.lines.map((line) => line.map(frame.point)) :
      [];
  if (places.length === 0 && lines.length === 0) return null;
  const view = {
    azimuth: -0.9,
    elevation: 0.35,
    pose: 0,
    before: true,
    after: true,
    places: thinned(places, 400),
    lines,
    frame
  };
  const extent =
      extentOf([...places.map((place) => place.at), ...lines.flat()]);
  view.centre = extent.centre;
  view.factor = niceFactor(
      extent.size * 0.1 /
      (maxOf(places.map((place) => place.errorBefore)) || 1));
  view.pose = worstPose(entry.picture, places);
  return armFigure(entry, view);
}

const thinned = (items, most) => {
  const every = Math.ceil(items.length / most);
  return every <= 1 ? items : items.filter((item, i) => i % every === 0);
};

function extentOf(points) {
  const sides = [0, 1, 2].map((k) => points.map((point) => point[k]));
  const low = sides.map(minOf), high = sides.map(maxOf);
  return {
    centre: low.map((v, k) => (v + high[k]) / 2),
    size: maxOf(low.map((v, k) => high[k] - v)) || 1
  };
}

// 1, 2 or 5 times a power of ten.
function niceFactor(rough) {
  if (!isNumber(rough) || rough <= 1) return 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * (rough / power >= 5 ? 5 : rough / power >= 2 ? 2 : 1);
}

// The pose that is drawn first: where the arm was farthest off.
function worstPose(picture, places) {
  if (!picture || places.length === 0) return 0;
  const errors =
      new Map(places.map((place) => [place.pose, place.errorBefore]));
  const drawn = picture.poses.map((pose) => errors.get(pose) || 0);
  return drawn.indexOf(maxOf(drawn));
}

function armFigure(entry, view) {
  let redraw = () => {};
  const said = h('output', {class: 'small'}, poseText(entry, view));
  const toggle = (key, text) =>
      h('button', {
        type: 'button',
        'aria-pressed': 'true',
        onclick: (event) => {
          view[key] = !view[key];
          event.target.setAttribute('aria-pressed', String(view[key]));
          redraw();
        }
      },
        text);
  const pose = view.lines.length > 1 &&
      slider('pose at which the arm is drawn', view.lines.length - 1, view.pose,
             (value) => {
               view.pose = value;
               said.textContent = poseText(entry, view);
               redraw();
             });
  const draw = (width) => {
    const svg = drawArm(width, view);
    // The element stays, which may hold the pointer.
    redraw = () => svg.replaceChildren(...drawArm(width, view).childNodes);
    turnable(svg, view, () => redraw());
    return svg;
  };
  return figure({
    id: 'arm',
    title: 'The arm and its errors where it was measured',
    draw,
    controls:
        h('div', {class: 'controls'}, toggle('before', 'errors before'),
          toggle('after', 'errors after'),
          pose && h('label', {}, 'Arm at pose ', pose), said),
    note: `Errors are drawn ${grouped(view.factor)} times as long as they ` +
        'are, from the measured point towards where the arm believed to be. ' +
        'Drag, or use the arrow keys, to turn the view.'
  });
}

function poseText(entry, view) {
  if (view.lines.length === 0) return '';
  const pose = entry.picture.poses[view.pose];
  const place = view.places.find((item) => item.pose === pose);
  return `pose ${pose}` +
      (place ? `: ${num(place.errorBefore)} mm before, ${
                   num(place.errorAfter)} mm after` :
               '');
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

function drawArm(width, view) {
  const height = Math.round(Math.min(440, Math.max(280, width * 0.72)));
  const project = projection(view);
  const arm = view.lines.length > 0 ? view.lines[view.pose] : [];
  const all = [
    ...view.places.map((place) => place.at), ...view.lines.flat()
  ].map(project);
  const low = [0, 1].map((k) => minOf(all.map((point) => point[k])));
  const high = [0, 1].map((k) => maxOf(all.map((point) => point[k])));
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
  const svg = canvas(
      width, height,
      'The arm as a chain of links, ' +
          count(view.places.length, 'measured place') +
          ', and the position errors ' +
          'before and after calibration as lines');
  svg.append(
      floorCircle(view, at), armLinks(arm, at), ...errorVectors(view, at),
      axesTriad(view, at, unit), viewLegend(view, unit, height));
  return svg;
}

// A circle about the base shows which way is up and how far it reaches.
function floorCircle(view, at) {
  const radius =
      maxOf([...view.places.map((place) => place.at), ...view.lines.flat()].map(
          (v) => Math.hypot(v[0], v[1])));
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
      s('path',
        {class: 'joint', d: marksPath(corners.slice(0, -1), 'circle', 4)}));
}

function errorVectors(view, at) {
  const shapes = [];
  const ends = (key) => view.places.map(
      (place) => at(place.at.map((v, k) => v + view.factor * place[key][k])));
  const starts = view.places.map((place) => at(place.at));
  for (const [key, className] of [['before', 'c1'], ['after', 'c2']]) {
    if (!view[key]) continue;
    const tips = ends(key);
    shapes.push(s('path', {
      class: 'vector ' + className,
      d: starts.map((start, i) => `M${start}L${tips[i]}`).join('')
    }));
  }
  shapes.push(s('path', {
    class: 'mark ' + (view.after ? 'c2' : 'c3'),
    d: marksPath(starts, 'circle', view.places.length > 150 ? 1.5 : 2.4)
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
      words(tip[0] + 3, tip[1] + 3, name, 'tick', 'start')
    ];
  }));
}

// What the lines are, and how long 1 mm of error and 100 mm of arm are drawn.
function viewLegend(view, unit, height) {
  const error = niceFactor(60 / (unit * view.factor) * 1000) / 1000;
  const arm = niceFactor(60 / unit);
  const scaleBar = (y, size, text, className) =>
      [s('path', {class: className, d: `M12,${y}h${round(size)}`}),
       words(12 + size + 6, y + 4, text, 'legend', 'start')];
  return s(
      'g', {}, s('path', {class: 'vector', d: 'M12,12h18'}),
      words(36, 16, 'error before', 'legend', 'start'),
      s('path', {class: 'mark c2', d: MARKS.circle(129, 12, 2.4)}),
      s('path', {class: 'vector c2', d: 'M129,12h14'}),
      words(150, 16, 'measured point, error after', 'legend', 'start'),
      scaleBar(
          height - 26, error * unit * view.factor, num(error) + ' mm of error',
          'vector'),
      scaleBar(height - 10, arm * unit, num(arm) + ' mm', 'axis'));
}
