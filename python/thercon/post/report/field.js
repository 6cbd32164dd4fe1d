'use strict';
// The deformed bodies with one field: a raster of colour bands below outlines in SVG.
function fieldPicture(data, {$, floats, integers, wholes, show, html, put, ticks, loadWords, withUnit, later}) {
const BANDS = 14, UNIFORM = 1e-3;   // of the largest magnitude: a smaller range has one colour
const all = data.fields, points = floats(all.points), count = points.length / 2;
const nodes = integers(all.node_id), displacement = all.displacement && wholes(all.displacement);
const edges = integers(all.edges), boundary = integers(all.boundary);
const groups = all.cells.map(cell => ({...cell, connectivity: integers(cell.connectivity),
   body: integers(cell.body), member: integers(cell.member), element: integers(cell.element)}));
const rigid = all.rigid.map(each => ({...each, points: floats(each.points), motion: floats(each.motion)}));
const elements = groups.reduce((sum, group) => sum + group.member.length, 0);
const quantities = all.quantities.map(each => ({...each, values: wholes(each.values)}));
const bodies = [...new Set(groups.flatMap(group => Array.from(group.body)))].sort((a, b) => a - b);
const palettes = Object.fromEntries(Object.entries(data.colours).map(([name, hex]) =>
   [name, hex.match(/.{6}/g).map(c => [0, 2, 4].map(k => parseInt(c.slice(k, k + 2), 16)))]));

put($('quantity'), html`${quantities.map((each, k) => html`<option value="${k}">${each.label}</option>`)}`);
$('quantity').value = String(all.first);
if (bodies.length === 1) $('apart').parentElement.hidden = true;
if (!all.near) $('region').parentElement.hidden = true;
if (!displacement) $('scale').parentElement.hidden = true;
for (const id of ['quantity', 'region', 'scale', 'fixed', 'apart', 'low', 'high']) $(id).addEventListener('input', later);

// Shape functions at the points of a cut element, and its triangles.
function cut(kind, n) {
   const weights = [], place = {}, triangles = [], isTriangle = kind === 5 || kind === 22;
   for (let j = 0; j <= n; j++) for (let i = 0; i <= n; i++) {
      if (isTriangle && i + j > n) continue;
      place[[i, j]] = weights.length;
      weights.push(shape(kind, isTriangle ? i / n : 2 * i / n - 1, isTriangle ? j / n : 2 * j / n - 1));
   }
   const add = (...corners) => { if (corners.every(c => c in place)) triangles.push(corners.map(c => place[c])); };
   for (let j = 0; j < n; j++) for (let i = 0; i < n; i++) {
      add([i, j], [i + 1, j], [i, j + 1]);
      add([i + 1, j], [i + 1, j + 1], [i, j + 1]);
   }
   return {weights, triangles};
}
function shape(kind, r, s) {
   if (kind === 5) return [1 - r - s, r, s];
   if (kind === 22) {
      const t = 1 - r - s;
      return [t * (2 * t - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * r * t, 4 * r * s, 4 * s * t];
   }
   const ends = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
   if (kind === 9) return ends.map(([a, b]) => 0.25 * (1 + r * a) * (1 + s * b));
   return [...ends.map(([a, b]) => 0.25 * (1 + r * a) * (1 + s * b) * (r * a + s * b - 1)),
      0.5 * (1 - r * r) * (1 - s), 0.5 * (1 + r) * (1 - s * s), 0.5 * (1 - r * r) * (1 + s), 0.5 * (1 - r) * (1 - s * s)];
}
const pieces = Math.max(1, Math.min(8, Math.round(Math.sqrt(16000 / elements))));
for (const group of groups) group.cut = cut(group.kind, pieces);

function moved(step, factor) {
   const found = Float64Array.from(points);
   if (displacement)
      for (let k = 0; k < 2 * count; k++) found[k] += factor * displacement[step * 2 * count + k];
   return found;
}
// Drawings of rigid bodies as they follow their nodes, as lists of x, y.
function rigidLines(step, factor) {
   return rigid.map(({points: line, motion, centre: [x0, y0]}) => {
      const [ux, uy, turn] = motion.subarray(3 * step, 3 * step + 3), found = Float64Array.from(line);
      for (let k = 0; k < line.length; k += 2) {
         found[k] += factor * (ux - turn * (line[k + 1] - y0));
         found[k + 1] += factor * (uy + turn * (line[k] - x0));
      }
      return found;
   });
}
function windowOf(places, lines) {
   const box = [Infinity, Infinity, -Infinity, -Infinity];
   if ($('region').value === 'near') {
      const [[x0, y0], [x1, y1]] = all.near;
      return [x0, y0, x1, y1];
   }
   for (let k = 0; k < count; k++) {
      box[0] = Math.min(box[0], places[2 * k]); box[2] = Math.max(box[2], places[2 * k]);
      box[1] = Math.min(box[1], places[2 * k + 1]); box[3] = Math.max(box[3], places[2 * k + 1]);
   }
   const size = Math.max(box[2] - box[0], box[3] - box[1]), reach = 0.15 * size, room = 0.02 * size;
   const [x0, y0, x1, y1] = box;
   for (const line of lines)
      for (let k = 0; k < line.length; k += 2) {
         const [x, y] = [line[k], line[k + 1]];
         if (x < x0 - reach || x > x1 + reach || y < y0 - reach || y > y1 + reach) continue;
         box[0] = Math.min(box[0], x); box[2] = Math.max(box[2], x);
         box[1] = Math.min(box[1], y); box[3] = Math.max(box[3], y);
      }
   return [box[0] - room, box[1] - room, box[2] + room, box[3] + room];
}

// Values of one body that lie in the window, with the areas that they stand for, in ascending order: at
// one step or, for the same colours at all loads, at all.
function valuesOf(quantity, body, steps, places, box) {
   const found = [], size = quantity.of === 'points' ? count : elements, taken = new Map();
   for (const group of groups)
      for (let e = 0; e < group.member.length; e++) {
         if (group.body[e] !== body) continue;
         let inside = false;
         const area = areaOf(group, e, places), add = (p, part) => taken.set(p, (taken.get(p) || 0) + part);
         for (let k = 0; k < group.nodes; k++) {
            const p = group.connectivity[e * group.nodes + k], x = places[2 * p], y = places[2 * p + 1];
            const isIn = x >= box[0] && x <= box[2] && y >= box[1] && y <= box[3];
            inside = inside || isIn;
            if (quantity.of === 'points' && isIn) add(p, area / group.nodes);
         }
         if (quantity.of === 'elements' && inside) add(group.member[e], area);
      }
   for (const step of steps) for (const [p, area] of taken) found.push([quantity.values[step * size + p], area]);
   return found.filter(([value]) => Number.isFinite(value)).sort((a, b) => a[0] - b[0]);
}
function areaOf(group, e, places) {
   const corners = group.kind === 5 || group.kind === 22 ? 3 : 4, at = k => group.connectivity[e * group.nodes + k % corners];
   let twice = 0;
   for (let k = 0; k < corners; k++)
      twice += places[2 * at(k)] * places[2 * at(k + 1) + 1] - places[2 * at(k + 1)] * places[2 * at(k) + 1];
   return 0.5 * Math.abs(twice);
}
// The range of values; where half a percent of the area at either end extends it far, without these.
function rangeOfMost(values, peak) {
   const whole = values.reduce((sum, [, area]) => sum + area, 0);
   let before = 0, low, high;
   for (const [value, area] of values) {
      before += area;
      if (low === undefined && before >= 0.005 * whole) low = value;
      if (high === undefined && before >= 0.995 * whole) high = value;
   }
   const ends = [values[0][0], values.at(-1)[0]];
   return high - low > UNIFORM * peak && ends[1] - ends[0] > 1.5 * (high - low) ? [low, high] : ends;
}
// One scale for all bodies; where it is asked for, those whose ranges differ tenfold have their own.
function scalesOf(quantity, steps, places, box) {
   const peak = quantity.values.reduce((most, v) => Number.isFinite(v) ? Math.max(most, Math.abs(v)) : most, 0);
   const found = [];
   const ranges = bodies.map(body => ({body, values: valuesOf(quantity, body, steps, places, box)}))
      .filter(({values}) => values.length)
      .map(range => ({...range, extent: range.values.at(-1)[0] - range.values[0][0]}))
      .sort((a, b) => b.extent - a.extent);
   for (const {body, values, extent} of ranges) {
      const last = found.at(-1);
      if (last && (!$('apart').checked || extent > 0.1 * last.extent || extent <= UNIFORM * peak)) {
         last.bodies.push(body);
         last.values = last.values.concat(values);
      } else found.push({bodies: [body], values, extent});
   }
   for (const scale of found) {
      scale.values.sort((a, b) => a[0] - b[0]);
      scale.ends = [scale.values[0][0], scale.values.at(-1)[0]];
      [scale.low, scale.high] = quantity.key === 'temperature' ? scale.ends : rangeOfMost(scale.values, peak);
   }
   const [low, high] = ['low', 'high'].map(id => $(id).value === '' ? NaN : Number($(id).value));
   for (const scale of found) {
      scale.isGiven = Number.isFinite(low) || Number.isFinite(high);
      scale.low = Number.isFinite(low) ? low : scale.low;
      scale.high = Number.isFinite(high) ? Math.max(high, scale.low) : Math.max(scale.high, scale.low);
   }
   return found.map(scale => levelled(scale, quantity, peak));
}
// Levels and their colours, which mean the same in every picture: red is positive, as tension, and blue
// negative, the darker the larger; of quantities without a sign bright is large.
function levelled({low, high, ends, isGiven, bodies}, quantity, peak) {
   const isUniform = high - low <= UNIFORM * peak, value = 0.5 * (low + high);
   const inner = isUniform ? [] : ticks(low, high, BANDS - 2);
   let step = inner.length > 1 ? inner[1] - inner[0] : 2 * peak || 1;
   let first = isUniform ? value - 0.5 * step : step * Math.floor(low / step + 1e-6);
   let last = isUniform ? value + 0.5 * step : step * Math.ceil(high / step - 1e-6);
   if (isGiven && !isUniform && Math.max(low - first, last - high) > 1e-6 * step) [first, last, step] = [low, high, 0.1 * (high - low)];
   const bands = Math.max(1, Math.round((last - first) / step));
   const middles = Array.from({length: bands}, (_, k) => first + (k + 0.5) * step), sizes = middles.map(Math.abs);
   const least = first < 0 && last > 0 ? 0 : Math.min(...sizes), range = Math.max(...sizes) - least;
   const places = middles.map((middle, k) => bands === 1 ? 0.5 : quantity.signed ? 0.15 + 0.85 * (sizes[k] - least) / range : k / (bands - 1));
   const signed = places.map((place, k) => quantity.signed ? 0.5 + 0.5 * Math.sign(Math.abs(middles[k]) > 1e-9 * peak ? middles[k] : 0) * place : place);
   const colours = palettes[quantity.signed ? 'RdBu_r' : quantity.key === 'temperature' ? 'inferno' : 'viridis'];
   const shades = signed.map(place => colours[Math.round(place * (colours.length - 1))]);
   const slack = 1e-4 * (last - first), isPast = [ends[0] < first - slack, ends[1] > last + slack];
   return {bodies, first, last, step, bands, shades, value: isUniform ? value : null, isPast: isPast.map(past => past && !isUniform)};
}

function paint(places, quantity, step, scales, box, canvas) {
   const shown = Math.min(900, $('panel').clientWidth || 700);
   const ratio = (box[3] - box[1]) / (box[2] - box[0]);
   const width = Math.round(Math.min(2 * shown, 1600, 1500 / ratio)), height = Math.max(1, Math.round(width * ratio));
   canvas.width = width; canvas.height = height;
   const context = canvas.getContext('2d'), image = context.createImageData(width, height);
   const pixels = new Uint32Array(image.data.buffer), size = width / (box[2] - box[0]);
   const scaleOf = new Map(scales.flatMap(scale => scale.bodies.map(body => [body, scale])));
   for (const scale of scales) scale.packed = scale.shades.map(([r, g, b]) => (255 << 24 | b << 16 | g << 8 | r) >>> 0);
   for (const group of groups) {
      const {weights, triangles} = group.cut, n = group.nodes;
      const x = new Float64Array(weights.length), y = x.slice(), v = x.slice();
      for (let e = 0; e < group.member.length; e++) {
         const scale = scaleOf.get(group.body[e]);
         if (!scale) continue;
         for (let p = 0; p < weights.length; p++) {
            x[p] = y[p] = v[p] = 0;
            for (let k = 0; k < n; k++) {
               const node = group.connectivity[e * n + k], w = weights[p][k];
               x[p] += w * places[2 * node]; y[p] += w * places[2 * node + 1];
               if (quantity.of === 'points') v[p] += w * quantity.values[step * count + node];
            }
            if (quantity.of === 'elements') v[p] = quantity.values[step * elements + group.member[e]];
            if (quantity.key === 'von_mises') v[p] = Math.max(0, v[p]);
            x[p] = (x[p] - box[0]) * size; y[p] = height - (y[p] - box[1]) * size;
         }
         for (const [a, b, c] of triangles)
            fill(pixels, width, height, [x[a], y[a], v[a]], [x[b], y[b], v[b]], [x[c], y[c], v[c]], scale);
      }
   }
   context.putImageData(image, 0, 0);
   return {width, height, size};
}
function fill(pixels, width, height, a, b, c, scale) {
   const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
   if (area === 0 || !Number.isFinite(a[2] + b[2] + c[2])) return;
   const left = Math.max(0, Math.ceil(Math.min(a[0], b[0], c[0]) - 0.5)), right = Math.min(width - 1, Math.floor(Math.max(a[0], b[0], c[0]) + 0.5));
   const top = Math.max(0, Math.ceil(Math.min(a[1], b[1], c[1]) - 0.5)), foot = Math.min(height - 1, Math.floor(Math.max(a[1], b[1], c[1]) + 0.5));
   for (let j = top; j <= foot; j++) for (let i = left; i <= right; i++) {
      const s = ((i - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (j - a[1])) / area;
      const t = ((b[0] - a[0]) * (j - a[1]) - (i - a[0]) * (b[1] - a[1])) / area;
      if (s < -1e-6 || t < -1e-6 || s + t > 1 + 1e-6) continue;
      const value = a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]);
      const band = Math.floor((value - scale.first) / scale.step + 1e-4);
      pixels[j * width + i] = scale.packed[Math.max(0, Math.min(scale.bands - 1, band))];
   }
}

function curves(list, places, box, {height, size}) {
   const X = k => ((places[2 * k] - box[0]) * size), Y = k => (height - (places[2 * k + 1] - box[1]) * size);
   let path = '';
   for (let e = 0; e < list.length; e += 3) {
      const [a, b, m] = [list[e], list[e + 1], list[e + 2]];
      const end = `${X(b).toFixed(1)} ${Y(b).toFixed(1)}`;
      path += `M${X(a).toFixed(1)} ${Y(a).toFixed(1)}` + (m < 0 ? `L${end}` :
         `Q${(2 * X(m) - 0.5 * (X(a) + X(b))).toFixed(1)} ${(2 * Y(m) - 0.5 * (Y(a) + Y(b))).toFixed(1)} ${end}`);
   }
   return path;
}
// A drawing with short strokes on its left, where the rigid body is.
function strokes(line, box, {width, height, size}) {
   const at = k => [(line[2 * k] - box[0]) * size, height - (line[2 * k + 1] - box[1]) * size];
   const gap = Math.max(width, height) / 45, long = 0.45 * gap;
   let path = '', next = 0.5 * gap;
   for (let k = 1; k < line.length / 2; k++) {
      const [x0, y0] = at(k - 1), [x1, y1] = at(k), far = Math.hypot(x1 - x0, y1 - y0);
      path += `${k === 1 ? `M${x0.toFixed(1)} ${y0.toFixed(1)}` : ''}L${x1.toFixed(1)} ${y1.toFixed(1)}`;
      const marks = [];
      for (; next < far; next += gap) {
         const [tx, ty] = [(x1 - x0) / far, (y1 - y0) / far];
         // Downwards on the screen y grows: the left of (tx, ty) is (ty, -tx).
         marks.push(`M${(x0 + next * tx).toFixed(1)} ${(y0 + next * ty).toFixed(1)}l${(long * (ty - tx)).toFixed(1)} ${(long * (-tx - ty)).toFixed(1)}`);
      }
      next -= far;
      if (marks.length) path += `${marks.join('')}M${x1.toFixed(1)} ${y1.toFixed(1)}`;
   }
   return path;
}
function drawBars(scales, quantity, tallest) {
   const H = Math.max(150, Math.min(300, tallest) / scales.length) + 50;
   put($('bars'), html`${scales.map(scale => {
      const tall = (H - 58) / scale.bands, out = [];
      scale.shades.forEach(([r, g, b], k) => out.push(html`<rect x="4" y="${42 + (scale.bands - 1 - k) * tall}" width="18" height="${tall + 0.3}" fill="rgb(${r},${g},${b})"/>`));
      // Arrows where values are beyond the colours.
      const [[r0, g0, b0], [r1, g1, b1]] = [scale.shades[0], scale.shades.at(-1)], foot = H - 16;
      if (scale.isPast[0]) out.push(html`<path class="beyond" d="M4 ${foot}h18l-9 11z" fill="rgb(${r0},${g0},${b0})" stroke="var(--ink)"/>`);
      if (scale.isPast[1]) out.push(html`<path class="beyond" d="M4 42h18l-9 -11z" fill="rgb(${r1},${g1},${b1})" stroke="var(--ink)"/>`);
      const every = scale.bands > 8 ? 2 : 1;
      const middle = 42 + 0.5 * scale.bands * tall;
      if (scale.value !== null) out.push(html`<path d="M22 ${middle}h5" stroke="var(--ink)"/><text x="31" y="${middle + 4}">${show(scale.value, 4)}</text>`);
      else for (let k = 0; k <= scale.bands; k++) {
         if (Math.round(scale.first / scale.step + k) % every) continue;
         const y = 42 + (scale.bands - k) * tall;
         out.push(html`<path d="M22 ${y}h5" stroke="var(--ink)"/><text x="31" y="${y + 4}">${show(scale.first + k * scale.step)}</text>`);
      }
      const whose = scales.length > 1 ? `bod${scale.bodies.length > 1 ? 'ies' : 'y'} ${scale.bodies.sort((a, b) => a - b).join(', ')}` : '';
      return html`<svg viewBox="0 0 136 ${H}" role="img" aria-label="Colours of ${quantity.label} ${whose}"><rect width="136" height="${H}" fill="var(--paper)"/><text x="4" y="12">${quantity.unit}</text>
         <text x="4" y="26">${whose}</text><rect x="4" y="42" width="18" height="${H - 58}" fill="none" stroke="var(--ink)"/>${out}</svg>`;
   })}`);
}
function tellRange(quantity, step, row, given, isPast) {
   const size = quantity.of === 'points' ? count : elements, values = quantity.values;
   let low = -1, high = -1;
   for (let k = step * size; k < (step + 1) * size; k++) {
      if (!Number.isFinite(values[k])) continue;
      if (low < 0 || values[k] < values[low]) low = k;
      if (high < 0 || values[k] > values[high]) high = k;
   }
   const names = new Map();
   if (quantity.of === 'elements') for (const g of groups) g.member.forEach((m, k) => names.set(m, g.element[k]));
   const where = k => quantity.of === 'points' ? `node ${nodes[k - step * size]}` : `element ${names.get(k - step * size)}`;
   const said = low < 0 ? 'no values at this increment' :
      `smallest ${show(values[low])} at ${where(low)}, largest ${show(values[high])} at ${where(high)}`;
   const late = row === given ? '' : ` (the page keeps no fields of increment ${given + 1})`;
   put($('range'), html`${withUnit(quantity.label, quantity.unit)}, ${loadWords(row)}${late}: <b>${said}</b>.${isPast ? ' Arrows: values lie beyond the colours, on at most 1 % of the area unless you chose the range.' : ''}`);
}

function draw(given) {
   let step = 0;
   for (let k = 0; k < all.rows.length; k++) if (all.rows[k] <= given) step = k;
   const quantity = quantities[Number($('quantity').value)], factor = displacement ? Math.max(0, Number($('scale').value)) : 0;
   const places = moved(step, factor), lines = rigidLines(step, factor), box = windowOf(places, lines);
   const steps = $('fixed').checked ? all.rows.map((_, k) => k) : [step];
   const scales = scalesOf(quantity, steps, places, box);
   const canvas = $('panel').querySelector('canvas'), shape = (box[2] - box[0]) / (box[3] - box[1]);
   $('panel').style.maxWidth = `min(100%, ${Math.round(640 * shape)}px)`;
   const frame = paint(places, quantity, step, scales, box, canvas);
   const thin = edges.length ? html`<path d="${curves(edges, places, box, frame)}" fill="none" stroke="var(--ink)" stroke-opacity="0.3" stroke-width="0.7"/>` : '';
   const drawings = lines.map(line => html`<path class="rigid" d="${strokes(line, box, frame)}" fill="none" stroke="var(--ink)" stroke-width="3"/>`);
   put($('lines'), html`<svg viewBox="0 0 ${frame.width} ${frame.height}" style="overflow:hidden" role="img" aria-label="${quantity.label} on the deformed bodies, ${loadWords(all.rows[step])}">
      ${thin}<path d="${curves(boundary, places, box, frame)}" fill="none" stroke="var(--ink)" stroke-width="2"/>
      ${drawings}</svg>`);
   drawBars(scales, quantity, $('panel').clientHeight);
   tellRange(quantity, step, all.rows[step], given, scales.some(scale => scale.isPast.includes(true)));
   $('field-note').textContent = [
      all.apart ? `${all.apart[0].toUpperCase()}${all.apart.slice(1)}.` : '',
      factor > 1 && all.overlaps && !all.apart ? `Displacements are drawn ${show(factor)} times too large, the initial gaps are not: bodies that touch seem to overlap by ${show(factor - 1)} times their initial gap.` : '',
      factor !== 1 && (all.apart || !all.overlaps) ? `Displacements are drawn ${show(factor)} times as large.` : '',
      scales.length > 1 ? 'Bodies whose ranges differ more than tenfold have their own colours.' : '',
   ].filter(Boolean).join(' ');
}
return {draw};
}
