// Values at places of a plane, as coloured squares with a colour bar; and rows
// of marks, one row a parameter or an arm.

// {x, y: {label, values}, value: {label, values, log}, tip, description}
function mapPlot(width, spec) {
  const bar = 34;
  const spanX = maxOf(spec.x.values) - minOf(spec.x.values) || 1;
  const spanY = maxOf(spec.y.values) - minOf(spec.y.values) || 1;
  const wide = width - 62 - 14;
  const tall = Math.max(120, Math.min(wide * spanY / spanX, 420));
  const height = Math.round(tall + 46 + 14 + bar);
  const box = {left: 62, right: width - 14, top: 14 + bar, bottom: height - 46};
  const unit = Math.min(wide / spanX, tall / spanY);
  const svg = canvas(width, height, spec.description);
  const middle = (values) => (maxOf(values) + minOf(values)) / 2;
  const placed = (values, low, high, axis, vertical) => scale(
      {
        ...axis,
        min: middle(values) - (high - low) / unit / 2 * 1.03,
        max: middle(values) + (high - low) / unit / 2 * 1.03,
        vertical
      },
      values, vertical ? high : low, vertical ? low : high);
  const x = placed(spec.x.values, box.left, box.right, spec.x, false);
  const y = placed(spec.y.values, box.top, box.bottom, spec.y, true);
  drawMapAxes(svg, x, y, box, height);
  const values = spec.value.values.filter(isNumber);
  const [low, high] = [minOf(values), maxOf(values)];
  const share = (v) => (high > low ? (v - low) / (high - low) : 0.5);
  const size = spec.size ?
      Math.max(spec.size * unit * 0.97, 2) :
      Math.max(
          2.5,
          Math.min(
              14, Math.sqrt(wide * tall / Math.max(values.length, 1)) * 0.62));
  const groups = new Map();
  const spots = [];
  spec.value.values.forEach((value, i) => {
    if (!isNumber(value)) return;
    const [px, py] = [x.at(spec.x.values[i]), y.at(spec.y.values[i])];
    const colour = rampColour(Math.round(share(value) * 40) / 40);
    groups.set(
        colour,
        (groups.get(colour) || '') +
            `M${round(px - size / 2)},${round(py - size / 2)}h${round(size)}v${
                round(size)}h${- round(size)}z`);
    if (spec.tip) spots.push({x: px, y: py, text: spec.tip(i)});
  });
  for (const [colour, d] of groups) svg.append(s('path', {d, fill: colour}));
  colourBar(svg, spec.value.label, low, high, box);
  attachTips(svg, spots);
  return svg;
}

function drawMapAxes(svg, x, y, box, height) {
  for (const tick of x.ticks) {
    svg.append(
        s('line', {
          class: 'grid',
          x1: round(x.at(tick.value)),
          x2: round(x.at(tick.value)),
          y1: box.top,
          y2: box.bottom
        }),
        words(
            round(x.at(tick.value)), box.bottom + 18, tick.text, 'tick',
            'middle'));
  }
  for (const tick of y.ticks) {
    svg.append(
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
  svg.append(
      words((box.left + box.right) / 2, height - 8, x.label, 'label', 'middle'),
      s('text', {
        class: 'label',
        'text-anchor': 'middle',
        transform: `translate(13 ${(box.top + box.bottom) / 2}) rotate(-90)`
      },
        y.label));
}

function colourBar(svg, label, low, high, box) {
  const steps = 40, wide = Math.min(180, (box.right - box.left) / 2.6);
  const left = box.right - wide;
  for (let i = 0; i < steps; ++i) {
    svg.append(s('rect', {
      x: round(left + i * wide / steps),
      y: 6,
      width: round(wide / steps + 0.5),
      height: 10,
      fill: rampColour(i / (steps - 1))
    }));
  }
  svg.append(
      words(left - 8, 15, label, 'legend', 'end'),
      words(left, 30, num(low), 'tick', 'start'),
      words(box.right, 30, num(high), 'tick', 'end'));
}

// Rows of marks: {rows: [{label, marks: [{at, lower, upper, className, marker,
// tip}], emphasised}], x: axis, legend, zeroLine, description}.
function rowPlot(width, spec) {
  const row = 20, top = spec.legend ? 34 : 12;
  const longest = maxOf(spec.rows.map((r) => r.label.length));
  const left = Math.min(longest * 7.4 + 16, width * 0.42);
  const height = top + spec.rows.length * row + 46;
  const box = {left, right: width - 16, top, bottom: height - 46};
  const svg = canvas(width, height, spec.description);
  const values = spec.rows.flatMap(
      (r) => r.marks.flatMap((m) => [m.at, m.lower, m.upper]));
  const x = scale(spec.x, values, box.left, box.right);
  for (const tick of x.ticks) {
    const at = round(x.at(tick.value));
    svg.append(
        s('line', {class: 'grid', x1: at, x2: at, y1: top, y2: box.bottom}),
        words(at, box.bottom + 18, tick.text, 'tick', 'middle'));
  }
  svg.append(
      words((left + box.right) / 2, height - 8, x.label, 'label', 'middle'));
  for (const line of spec.vlines || []) {
    if (line.x < x.low || line.x > x.high) continue;
    svg.append(s('line', {
      class: 'reference',
      x1: round(x.at(line.x)),
      x2: round(x.at(line.x)),
      y1: top,
      y2: box.bottom
    }));
  }
  if (spec.legend) {
    drawLegend(svg, spec.legend, {left: Math.min(left, 20)});
  }
  const spots = [];
  spec.rows.forEach((r, i) => {
    const y = top + (i + 0.5) * row;
    const fits = Math.floor((left - 10) / 6.4);
    svg.append(words(
        left - 8, y + 4,
        r.label.length > fits ? r.label.slice(0, fits - 1) + '…' : r.label,
        r.emphasised ? 'row-label strong' : 'row-label', 'end'));
    for (const mark of r.marks) drawRowMark(svg, x, y, mark, spec, spots);
  });
  attachTips(svg, spots);
  return svg;
}

function drawRowMark(svg, x, y, mark, spec, spots) {
  const usable = (v) => isNumber(v) && (!spec.x.log || v > 0);
  if (mark.lower !== undefined && !(spec.x.log && !(mark.lower > 0))) {
    const [low, high] =
        [Math.max(mark.lower, x.low), Math.min(mark.upper, x.high)];
    const [left, right] = [round(x.at(low)), round(x.at(high))];
    svg.append(s('line', {
      class: 'whisker ' + mark.className,
      x1: left,
      x2: right,
      y1: y,
      y2: y
    }));
    // Arrows where it goes on.
    const tips =
        [[mark.lower < x.low, left, 6], [mark.upper > x.high, right, -6]];
    for (const [beyond, end, back] of tips) {
      if (!beyond) continue;
      svg.append(s(
          'path',
          {class: 'mark ' + mark.className, d: `M${end},${y}l${back},-4v8z`}));
    }
  }
  if (!usable(mark.at)) return;
  const at = x.at(mark.at);
  svg.append(s('path', {
    class: 'mark ' + mark.className,
    d: MARKS[mark.marker || 'circle'](at, y, mark.size || 4.5)
  }));
  if (mark.tip) spots.push({x: at, y, text: mark.tip});
}
