'use strict';
(async () => {
const $ = id => document.getElementById(id);
const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
const unpacked = new Blob([bytes($('data').textContent)]).stream().pipeThrough(new DecompressionStream('gzip'));
const data = JSON.parse(await new Response(unpacked).text());
const floats = text => new Float32Array(bytes(text).buffer);
function integers(text) {
   const found = new Int32Array(bytes(text).buffer);
   for (let k = 1; k < found.length; k++) found[k] += found[k - 1];
   return found;
}
// Values of all steps, of which each has its whole numbers from 0 to 65534; 65535 is no value.
function wholes({low, high, parts}) {
   const given = new Uint16Array(bytes(parts).buffer), size = given.length / low.length;
   return Float32Array.from(given, (part, k) => {
      const step = Math.floor(k / size);
      return part === 65535 ? NaN : low[step] + (high[step] - low[step]) * part / 65534;
   });
}
const INK = 'var(--ink)', PAPER = 'var(--paper)', BLUE = 'var(--blue)', VERMILION = '#d55e00', GREY = 'var(--dim)';

// ---- words ----
// What html`...` makes: each value put into it is escaped, unless it is such HTML, or a list of it.
class Markup { constructor(text) { this.text = text; } }
const escaped = text => String(text).replace(/[&<>"']/g,
   c => ({'&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;', "'": '&#39;'})[c]);
const textOf = value => value instanceof Markup ? value.text :
   Array.isArray(value) ? value.map(textOf).join('') : escaped(value);
const html = (parts, ...values) =>
   new Markup(parts.reduce((text, part, k) => text + textOf(values[k - 1]) + part));
// The one way by which HTML comes onto the page.
function put(box, markup) {
   if (!(markup instanceof Markup)) throw new TypeError('no HTML made by html`...`');
   box.innerHTML = markup.text;
}
function show(value, digits = 5) {
   if (!Number.isFinite(value)) return '–';
   const size = Math.abs(value);
   const words = value === 0 ? '0' : size >= 1e6 || size < 1e-4 ?
      value.toExponential(digits - 2).replace(/\.?0+e/, 'e').replace('e+', 'e') :
      String(Number(value.toPrecision(digits)));
   return words.replaceAll('-', '−');
}
const within = ({uncertainty}, k) => Number.isFinite(uncertainty[k]) ? ` ± ${show(uncertainty[k], 2)}` : '';
const withUnit = (words, unit) => unit ? `${words} (${unit})` : words;
const unit = name => data.units[name] || '';

// ---- one chart: axes, lines, marks ----
function ticks(low, high, most) {
   const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
   const step = power * [1, 2, 2.5, 5, 10].find(m => m * power >= raw * 0.999);
   const found = [];
   for (let k = Math.ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; k++)
      found.push(Number((k * step).toPrecision(12)));
   return found;
}
// Fewer where their labels would touch, on an axis of this length [px].
function roomyTicks(low, high, most, length) {
   const found = ticks(low, high, most), apart = length * (found[1] - found[0]) / (high - low);
   return most > 1 && apart < 8 + widest(found) ? roomyTicks(low, high, most - 1, length) : found;
}
const pen = document.createElement('canvas').getContext('2d');
pen.font = '13px system-ui, "Liberation Sans", Arial, sans-serif';   // that of charts
const widthOf = words => pen.measureText(words).width;
const widest = numbers => Math.max(...numbers.map(v => widthOf(show(v))));
const finite = values => Array.from(values).filter(Number.isFinite);
function rangeOf(values, zero) {
   let low = zero ? 0 : Infinity, high = zero ? 0 : -Infinity;
   for (const v of values) if (Number.isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); }
   if (low > high || (low === 0 && high === 0)) return [0, 1];
   const isWide = high - low > 1e-4 * Math.max(Math.abs(low), Math.abs(high));   // labels tell its ends apart
   const room = isWide ? 0.06 * (high - low) : 0.5 * Math.abs(high) || 0.5;
   return [zero && low === 0 && high > 0 ? 0 : low - room, zero && high === 0 && low < 0 ? 0 : high + room];
}
const peak = values => values.reduce((most, v) => Math.abs(v) > most ? Math.abs(v) : most, 0);
// lines: {x, y, off, colour, dash, mark, name}, off the uncertainties of y; clouds: {points, shape, colour, name}; uprights: [x]
function chart(box, options) {
   const W = Math.min(options.width || 480, box.clientWidth || box.parentElement.clientWidth || 480);   // empty ones have none
   const H = options.height || 300;
   const [x0, x1] = options.xRange, [y0, y1] = options.yRange;
   const left = Math.max(50, 32 + widest(ticks(y0, y1, 5))), right = 10, top = 14, bottom = 44;
   const X = v => left + (v - x0) / (x1 - x0) * (W - left - right);
   const Y = v => H - bottom - (v - y0) / (y1 - y0) * (H - top - bottom);
   const out = [], id = `${box.id}-clip`;
   out.push(html`<clipPath id="${id}"><rect x="${left}" y="${top}" width="${W - left - right}" height="${H - top - bottom}"/></clipPath>`);
   for (const t of roomyTicks(x0, x1, 6, W - left - right))
      out.push(html`<path d="M${X(t)} ${H - bottom}v5" stroke="var(--ink)"/><text class="tick" x="${X(t)}" y="${H - bottom + 18}" text-anchor="middle">${show(t)}</text>`);
   for (const t of ticks(y0, y1, 5))
      out.push(html`<path d="M${left} ${Y(t)}H${W - right}" stroke="var(--rule)"/><text class="tick" x="${left - 6}" y="${Y(t) + 4}" text-anchor="end">${show(t)}</text>`);
   out.push(html`<g clip-path="url(#${id})">`);
   for (const cloud of options.clouds || [])
      out.push(html`<path d="${cloud.points.map(([x, y]) => cloud.shape(X(x), Y(y))).join('')}" fill="${cloud.fill}" stroke="${cloud.colour}"/>`);
   if (y0 < 0 && y1 > 0) out.push(html`<path d="M${left} ${Y(0)}H${W - right}" stroke="var(--dim)"/>`);
   for (const x of options.uprights || [])
      out.push(html`<path d="M${X(x)} ${top}V${H - bottom}" stroke="var(--ink)" stroke-dasharray="2 3" class="upright"/>`);
   for (const line of options.lines) {
      let path = '', pen = 'M', marks = '', bars = '';
      for (let k = 0; k < line.x.length; k++) {
         const a = line.x[k], b = line.y[k];
         if (!Number.isFinite(a) || !Number.isFinite(b)) { pen = 'M'; continue; }
         path += `${pen}${X(a).toFixed(1)} ${Y(b).toFixed(1)}`;
         pen = 'L';
         if (line.off && Number.isFinite(line.off[k]))
            bars += `M${X(a).toFixed(1)} ${Y(b - line.off[k]).toFixed(1)}V${Y(b + line.off[k]).toFixed(1)}`;
         if (line.mark && !(line.plain && line.plain[k]))
            marks += `M${(X(a) - 2.6).toFixed(1)} ${Y(b).toFixed(1)}a2.6 2.6 0 1 0 5.2 0a2.6 2.6 0 1 0 -5.2 0`;
      }
      if (bars) out.push(html`<path d="${bars}" stroke="${GREY}" class="uncertainty"/>`);
      out.push(html`<path d="${path}" fill="none" stroke="${line.colour}" stroke-width="${line.width || 1.6}" stroke-dasharray="${line.dash || ''}"/>`);
      if (marks) out.push(html`<path d="${marks}" fill="${line.hollow ? PAPER : line.colour}" stroke="${line.colour}"/>`);
   }
   out.push(html`</g><rect x="${left}" y="${top}" width="${W - left - right}" height="${H - top - bottom}" fill="none" stroke="var(--ink)"/>`);
   out.push(html`<text x="${(left + W - right) / 2}" y="${H - 8}" text-anchor="middle">${options.xLabel}</text>`);
   if (options.yLabel)
      out.push(html`<text transform="translate(14 ${(top + H - bottom) / 2}) rotate(-90)" text-anchor="middle">${options.yLabel}</text>`);
   const total = H + legend(out, [...options.lines, ...(options.clouds || [])].filter(e => e.name), W, left, H + 14) ;
   // A browser that forces darkness leaves charts as they are, and so must find what is behind them there.
   out.unshift(html`<rect width="${W}" height="${total}" fill="var(--paper)"/>`);
   const caption = options.caption ? html`<figcaption>${options.caption}</figcaption>` : '';
   put(box, html`<svg viewBox="0 0 ${W} ${total}" role="img" aria-label="${options.title}">${out}</svg>${caption}`);
}
// Adds the entries below the axes; returns the height they take.
function legend(out, entries, width, left, top) {
   let x = left, y = top;
   for (const entry of entries) {
      const room = 38 + widthOf(entry.name);
      if (x > left && x + room > width) { x = left; y += 18; }
      out.push(entry.shape ? html`<path d="${entry.shape(x + 12, y - 4)}" fill="${entry.fill}" stroke="${entry.colour}"/>` :
         html`<path d="M${x} ${y - 4}h24" stroke="${entry.colour}" stroke-width="${entry.width || 1.6}" stroke-dasharray="${entry.dash || ''}"/>`);
      out.push(html`<text x="${x + 30}" y="${y}">${entry.name}</text>`);
      x += room + 10;
   }
   return entries.length ? y - top + 22 : 0;
}
const square = r => (x, y) => `M${(x - r).toFixed(1)} ${(y - r).toFixed(1)}h${2 * r}v${2 * r}h${-2 * r}z`;
const disc = r => (x, y) => `M${(x - r).toFixed(1)} ${y.toFixed(1)}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;

const dash = (x, y) => `M${(x - 4).toFixed(1)} ${y.toFixed(1)}h8`;

// ---- loads ----
const times = data.load.times, count = times.length;
const abscissa = data.load.rises ? data.load.values : times;
let row = count - 1;
const loadWords = k => `${data.load.label}${data.load.label === 'time' ? '' : ' ='} ${show(data.load.values[k])} ${data.load.unit}`.trim();
function tellLoad() {
   const time = data.load.label === 'time' ? '' : `, time ${show(times[row])} ${unit('time')}`.trimEnd();
   const factor = data.load.factors[row] === null ? '' : `, load factor ${show(data.load.factors[row])}`;
   $('now').textContent = `${row + 1} of ${count}: ${loadWords(row)}${time}${factor}`;
   $('unjudged').textContent = data.load.judged[row] ? '' : `Increment ${row + 1} is ${data.load.unjudged}, so tractions may scatter.`;
   $('load').setAttribute('aria-valuetext', $('now').textContent);
}

// ---- contact ----
const contacts = data.contacts.map(each => {
   const decoded = {...each, at: floats(each.at), status: bytes(each.status), zeros: integers(each.zeros), profiles: {}, edges: {}, curves: {}, main: {}};
   for (const key in each.profiles) decoded.profiles[key] = floats(each.profiles[key]);
   for (const key in each.edges) decoded.edges[key] = floats(each.edges[key]);
   for (const key in each.curves) decoded.curves[key] = each.curves[key].map(floats);
   for (const key in each.main) decoded.main[key] = floats(each.main[key]);
   return decoded;
});
const contact = () => contacts[$('interface') ? Number($('interface').value) : 0];
const part = chart => contact().parts[chart] && `${contact().parts[chart]}.`;
const rowOf = (values, width, k = row) => values.subarray(k * width, (k + 1) * width);
// Curves of edges over the load, one behind the other, and points of those that have one alone.
function edgeCurves(key) {
   const [rows, y] = contact().curves[key], x = Array.from(rows, k => abscissa[k]), alone = [];
   y.forEach((place, k) => {
      if (Number.isFinite(place) && ![y[k - 1], y[k + 1]].some(Number.isFinite)) alone.push([x[k], place]);
   });
   return {x, y, alone};
}
function drawZones() {
   const c = contact(), m = c.at.length, states = [[], [], []];
   for (let k = 0; k < count; k++)
      for (let i = 0; i < m; i++) states[c.status[k * m + i]].push([abscissa[k], c.at[i]]);
   const frictionless = !c.profiles.shear || c.friction === 0;
   const contactEdges = edgeCurves('contact'), stickEdges = edgeCurves('stick'), window = c.windows.zones;
   const room = 0.03 * (Math.max(...abscissa) - Math.min(...abscissa)) || 0.5;
   const margin = 0.04 * (window[1] - window[0]) || 0.5;
   const small = Math.min(3, Math.max(0.8, 130 / Math.max(count, 1)));
   chart($('zones'), {
      title: `Zones of interface ${c.name}: open, slip and stick over the load; the upright line is the load chosen`,
      xLabel: data.load.axis, yLabel: withUnit(c.axis, unit('length')),
      xRange: [Math.min(...abscissa) - room, Math.max(...abscissa) + room],
      yRange: [window[0] - margin, window[1] + margin],
      uprights: [abscissa[row]],
      clouds: [
         {points: states[0], shape: disc(0.4 * small), fill: GREY, colour: GREY, name: 'open'},
         {points: states[1], shape: disc(small), fill: PAPER, colour: BLUE, name: frictionless ? 'closed' : 'slip'},
         {points: states[2], shape: square(0.9 * small), fill: '#e69f00', colour: '#e69f00', name: 'stick'},
         {points: [...contactEdges.alone, ...stickEdges.alone], shape: dash, fill: INK, colour: INK},
      ].filter(cloud => cloud.points.length),
      lines: [
         {...contactEdges, colour: INK, name: 'edge of contact'},
         {...stickEdges, colour: INK, dash: '6 3', width: 2.6, name: 'edge of stick'},
      ].filter(line => finite(line.y).length),
      caption: `Zones. Each symbol is a contact point at one increment. ${part('zones')}`,
   });
}
function profile(id, title, quantities, label, zero, caption) {
   const c = contact(), m = c.at.length, window = c.windows.profiles, lines = [], all = [], now = [], uprights = [];
   for (const [key, name, colour, dash, factor = 1] of quantities) {
      const whole = c.profiles[key];
      if (!whole) continue;
      for (let i = 0; i < whole.length; i++)
         if (c.at[i % m] >= window[0] && c.at[i % m] <= window[1]) {
            all.push(factor * whole[i]);
            if (Math.floor(i / m) === row) now.push(factor * whole[i]);
         }
      const values = Array.from(rowOf(whole, m), v => factor * v), points = [];
      for (const [first, last] of c.pieces) {
         const piece = values.slice(first, last + 1).map((v, i) => [c.at[first + i], v, false]);
         // Tractions end where the contact does.
         if (zero) for (let k = 3; k >= 0; k--) {
            const before = c.zeros[4 * row + k];
            if (before > first && before <= last) piece.splice(before - first, 0, [c.edges.contact[4 * row + k], 0, true]);
         }
         points.push(...piece, [NaN, NaN, true]);
      }
      lines.push({x: points.map(p => p[0]), y: points.map(p => p[1]), plain: points.map(p => p[2]),
         colour, dash, name, mark: !dash, hollow: key === 'shear'});
   }
   put($(id), html``);
   if (!lines.length) return;
   for (const key of ['contact', 'stick']) uprights.push(...finite(rowOf(c.edges[key], 4)));
   const room = 0.02 * (window[1] - window[0]) || 0.5;
   const isRounding = peak(now) <= 1e-6 * peak(all);
   chart($(id), {title: `${title} along interface ${c.name}, ${loadWords(row)}`, lines, uprights,
      xLabel: withUnit(c.axis, unit('length')), yLabel: label, caption,
      xRange: [window[0] - room, window[1] + room], yRange: rangeOf($('same').checked || isRounding ? all : now, id !== 'faces')});
}
function drawProfiles() {
   const c = contact(), said = loadWords(row), mu = c.friction;
   profile('faces', 'Temperature of the faces', [['slave_temperature', 'slave', VERMILION, ''],
      ['master_temperature', 'master', BLUE, '']], withUnit('temperature', unit('temperature')), false,
      `Temperature of the faces, ${said}. ${part('profiles')}`);
   const shear = c.profiles.shear && c.profiles.shear.some(v => v !== 0);
   // Friction of one sign at this load is drawn positive, as in the pictures of post/plot.
   const values = shear ? rowOf(c.profiles.shear, c.at.length).filter(Number.isFinite) : [];
   const low = values.reduce((a, b) => Math.max(a, -b), 0), high = values.reduce((a, b) => Math.max(a, b), 0);
   const bothSigns = Math.min(low, high) > 0.02 * Math.max(low, high);
   const sign = !bothSigns && values.reduce((a, b) => a + b, 0) < 0 ? -1 : 1;
   const tractions = [['pressure', 'pressure p', INK, '']];
   if (shear) tractions.push(['shear', sign < 0 ? 'friction −τ' : 'friction τ', VERMILION, '', sign]);
   if (shear && mu) tractions.push(['pressure', bothSigns ? '±μp' : 'μp', GREY, '3 3', mu]);
   if (shear && mu && bothSigns) tractions.push(['pressure', '', GREY, '3 3', -mu]);
   profile('tractions', 'Contact tractions', tractions, withUnit('traction', unit('stress')), true,
      `Tractions, ${said}. Dotted lines are the edges of contact and stick. ${part('profiles')}`);
   profile('flux', 'Heat flux', [['heat_flux', 'heat flux q', INK, '']], withUnit('heat flux q', unit('flux')), false,
      `Heat flux from slave to master, ${said}.`);
   profile('gap', 'Gap', [['gap', 'gap', BLUE, '']], withUnit('gap', unit('length')), false, `Gap, ${said}.`);
   profile('wear', 'Wear', [['wear_slave', 'slave', VERMILION, ''], ['wear_master', 'master', BLUE, '']],
      withUnit('depth worn', unit('length')), false, `Depth that each face has lost, ${said}.`);
}
function drawTotals() {
   const c = contact(), words = [];
   const add = (name, value, of, off = '') => { if (Number.isFinite(value)) words.push(html`<span>${name} <b>${show(value)}</b>${off} ${of}</span>`); };
   for (const each of c.totals) add(each.label, each.values[row], each.unit, within(each, row));
   add(`edge of contact ${c.axis} =`, c.main.contact[row], unit('length'));
   add(`edge of stick ${c.axis} =`, c.main.stick[row], unit('length'));
   put($('totals'), html`${words}`);
}
function drawContact() {
   if (!contacts.length) return;
   drawZones();
   drawProfiles();
   drawTotals();
}

// ---- history ----
// Lines over the load factor of a branch: its unstable parts are dashed.
function branchLines(y) {
   const {factor, unstable} = data.branch, lines = [], seen = new Set();
   for (let first = 0; first < count;) {
      let behind = first + 1;
      while (behind < count && unstable[behind] === unstable[first]) behind++;
      const end = Math.min(behind + 1, count), name = data.branch.labels[Number(unstable[first])];
      lines.push({x: factor.slice(first, end), y: y.slice(first, end), colour: BLUE,
         dash: unstable[first] ? '5 3' : '', name: seen.has(name) ? '' : name});
      seen.add(name);
      first = behind;
   }
   lines.push({x: [factor[row]], y: [y[row]], colour: INK, mark: true});
   return lines;
}
// Curves of the nodes or points of a set, at the increments at which it was printed.
const SERIES = [INK, BLUE, VERMILION, '#009e73', '#e69f00', '#56b4e9'];
const setLines = ({at, curves}, along) => curves.map(({name, values}, n) => ({name, colour: SERIES[n],
   x: at.map(k => along[k]), y: values.map(v => v === null ? NaN : v), mark: at.length <= 60}));
// Ends of the bars of uncertainty; those of a curve that is less high than one of them are clipped.
const ends = (y, off) => peak(off) > peak(y) ? [] :
   y.flatMap((v, k) => Number.isFinite(off[k]) ? [v - off[k], v + off[k]] : []);
function drawHistories() {
   const along = data.branch ? data.branch.factor : abscissa;
   const low = Math.min(...along), high = Math.max(...along), room = 0.03 * (high - low) || 0.5;
   const box = $('histories');
   if (!box.childElementCount)
      put(box, html`${data.history.map((_, k) => html`<figure id="history-${k}"></figure>`)}`);
   data.history.forEach((each, k) => {
      const y = each.values.map(v => v === null ? NaN : v), sets = each.curves ? setLines(each, along) : null;
      chart($(`history-${k}`), {
         width: 360, height: 200, title: `${each.label} over the load`,
         xLabel: data.branch ? 'Load factor' : data.load.axis, xRange: [low - room, high + room],
         yLabel: each.unit, yRange: rangeOf(sets ? sets.flatMap(line => line.y) : [...y, ...ends(y, each.uncertainty)], !each.key.includes('temperature')),
         uprights: [along[row]],
         lines: sets || (data.branch ? branchLines(y) : [{x: abscissa, y, off: each.uncertainty, colour: BLUE, mark: count <= 60}]),
         caption: html`${each.label}: <b>${show(y[row])}</b>${within(each, row)} ${each.unit}`,
      });
   });
}

// ---- the rest of the page ----
let waiting = false;
function draw() {
   tellLoad();
   drawContact();
   drawHistories();
   if (data.fields) fields.draw(row);
   waiting = false;
}
function later() {
   if (!waiting) requestAnimationFrame(draw);
   waiting = true;
}
const fields = data.fields ? fieldPicture(data, {$, floats, integers, wholes, show, html, put, ticks, loadWords, withUnit, later}) : null;
if (!fields) $('fields').hidden = true;
const slider = $('load'), inTime = slider.step === 'any';
const nearest = time => times.reduce((best, t, k) => Math.abs(t - time) < Math.abs(times[best] - time) ? k : best, 0);
slider.addEventListener('input', () => { row = inTime ? nearest(Number(slider.value)) : Number(slider.value) - 1; later(); });
if (inTime) slider.addEventListener('keydown', event => {
   const next = row + ({ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1}[event.key] ?? NaN);
   if (Number.isNaN(next)) return;
   event.preventDefault();
   row = Math.min(count - 1, Math.max(0, next));
   slider.value = String(times[row]);
   later();
});
for (const id of ['interface', 'same']) if ($(id)) $(id).addEventListener('change', later);
for (const form of document.forms) form.addEventListener('submit', event => event.preventDefault());
slider.value = slider.max;
draw();
})();
