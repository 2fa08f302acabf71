// Axes: what range, which ticks, and how they are written.

// Up to `most` round numbers within a range.
function niceStep(span, most) {
  const rough = span / Math.max(most, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  return step * power;
}

// One axis from `from` to `to` pixels. `axis`: {label, log, min, max, integer,
// zero, low, high}; `values` are those it must show, but for those that are
// below `low` or above `high`.
function scale(axis, values, from, to) {
  const usable = values.filter(
      (v) => isNumber(v) && (!axis.log || v > 0) && !(v < axis.low) &&
          !(v > axis.high));
  let low = isNumber(axis.min) ? axis.min : minOf(usable);
  let high = isNumber(axis.max) ? axis.max : maxOf(usable);
  if (!isFinite(low) || !isFinite(high))
    [low, high] = axis.log ? [1, 10] : [0, 1];
  if (axis.zero && !axis.log)
    [low, high] = [Math.min(low, 0), Math.max(high, 0)];
  return axis.log ? logScale(axis, low, high, from, to) :
                    linearScale(axis, low, high, from, to);
}

function linearScale(axis, low, high, from, to) {
  if (low === high) {
    const room = Math.abs(low) * 0.1 || 1;
    [low, high] = [low - (axis.zero && low === 0 ? 0 : room), high + room];
  }
  const most =
      Math.max(2, Math.floor(Math.abs(to - from) / (axis.vertical ? 40 : 70)));
  let step = niceStep(high - low, most);
  if (axis.integer) step = Math.max(1, Math.round(step));
  if (!isNumber(axis.min)) low = Math.floor(low / step + 1e-9) * step;
  if (!isNumber(axis.max)) high = Math.ceil(high / step - 1e-9) * step;
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9;
       ++k) {
    ticks.push(k * step);
  }
  // Very small or large numbers share a power of ten, told in the label.
  const largest = Math.max(Math.abs(low), Math.abs(high));
  const power =
      largest < 1e-3 || largest >= 1e5 ? Math.floor(Math.log10(largest)) : 0;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) - power + 1e-9));
  return {
    at: (v) => from + (v - low) / (high - low) * (to - from),
    ticks: ticks.map(
        (v) =>
            ({value: v, text: fixed(v / 10 ** power, Math.min(decimals, 12))})),
    label: power === 0 ?
        axis.label :
        axis.label
            .replace(
                /\[(.*)\]|$/,
                (all, unit) => ' [10' + superscript(String(power)) +
                    (unit ? ' ' + unit : '') + ']')
            .replace('  ', ' '),
    low,
    high,
  };
}

function logScale(axis, low, high, from, to) {
  let first = Math.floor(Math.log10(low) + 1e-9);
  let last = Math.ceil(Math.log10(high) - 1e-9);
  if (first === last) ++last;
  const most =
      Math.max(2, Math.floor(Math.abs(to - from) / (axis.vertical ? 26 : 60)));
  const every = Math.max(1, Math.ceil((last - first) / most));
  const ticks = [];
  for (let e = first; e <= last; e += every) {
    ticks.push({value: 10 ** e, text: powerText(e)});
  }
  // Few decades: numbers between them too.
  if (last - first <= 2) {
    for (let e = first; e < last; ++e) {
      for (const factor of [2, 5]) {
        ticks.push({value: factor * 10 ** e, text: num(factor * 10 ** e, 1)});
      }
    }
  }
  const [a, b] = [first, last];
  return {
    at: (v) => from + (Math.log10(v) - a) / (b - a) * (to - from),
    ticks,
    label: axis.label,
    low: 10 ** a,
    high: 10 ** b,
  };
}

const powerText = (e) =>
    (e >= -2 && e <= 3 ? num(10 ** e, 1) : '10' + superscript(String(e)));

// Cividis, which readers with any colour vision see as a ramp of lightness.
const RAMP = [
  [0, 34, 78], [18, 53, 112], [59, 73, 108], [87, 93, 109], [112, 113, 115],
  [138, 134, 120], [165, 156, 116], [195, 179, 105], [225, 204, 85],
  [254, 232, 56]
];

function rampColour(t) {
  const place = Math.min(Math.max(t, 0), 1) * (RAMP.length - 1);
  const i = Math.min(Math.floor(place), RAMP.length - 2);
  const mixed =
      RAMP[i].map((c, k) => Math.round(c + (RAMP[i + 1][k] - c) * (place - i)));
  return 'rgb(' + mixed.join(',') + ')';
}
