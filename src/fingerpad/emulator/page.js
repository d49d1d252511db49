"use strict";
// The emulator of fingerpad.emulator, in the same few steps: a Gaussian process in the knobs,
// principal components, cubics in time. All numbers are SI.
const model = JSON.parse(document.getElementById("model").textContent, (key, value) => unpacked(value));
const FORCE = "motion[0].press_to_force", RATE = "motion[0].rate", CURVE = "stimulus.curvature";
const WARPS = { "linear": v => v, "logarithm": v => Math.log(v), "bent": bent };
const STEADY_DEPTHS = [600e-6, 915e-6];

// Arrays are in the page as bytes: a list of numbers, or of rows where they have columns.
function unpacked(value) {
  if (!value || value.float64 === undefined) return value;
  const bytes = Uint8Array.from(atob(value.float64), letter => letter.charCodeAt(0));
  const all = new Float64Array(bytes.buffer), rows = [];
  if (!value.columns) return all;
  for (let k = 0; k < all.length; k += value.columns) rows.push(all.subarray(k, k + value.columns));
  return rows;
}

// --- the mathematics -----------------------------------------------------------------------------

function bent(value, knob) {
  const share = model.bent * (value - knob.low) / (knob.high - knob.low);
  return share < 0 ? share : Math.log1p(share);
}

function scaled(knob, value) {
  const warp = v => WARPS[knob.warp](v, knob), low = warp(knob.low), high = warp(knob.high);
  return 2 * (warp(value) - low) / (high - low) - 1;
}

function legendre(x, degree) {
  const found = [1, x];
  for (let n = 1; n < degree; n++) {
    found.push(((2 * n + 1) * x * found[n] - n * found[n - 1]) / (n + 1));
  }
  return found;
}

// Polynomials of a point, then its covariance with each scene that was simulated (Matern's, 5/2).
function terms(point, scales) {
  const most = Math.max(1, ...model.powers[model.powers.length - 1]);
  const tables = point.map(x => legendre(x, most));
  const trend = model.powers.map(row => row.reduce((product, n, k) => product * tables[k][n], 1));
  return trend.concat(model.centres.map(centre => {
    const far = Math.sqrt(5) * Math.hypot(...centre.map((c, k) => (point[k] - c) / scales[k]));
    return (1 + far + far * far / 3) * Math.exp(-far);
  }));
}

function cubicWeights(grid, at) {
  const count = Math.min(4, grid.length);
  let first = grid.filter(g => g <= at).length - 2;
  first = Math.max(0, Math.min(first, grid.length - count));
  const weights = new Array(grid.length).fill(0);
  for (let k = first; k < first + count; k++) {
    weights[k] = 1;
    for (let j = first; j < first + count; j++) {
      if (j !== k) weights[k] *= (at - grid[j]) / (grid[k] - grid[j]);
    }
  }
  return weights;
}

const held = time => Math.log1p(time / model.soonest);

function momentWeights(share, hold) {
  const press = model.press.length, none = new Array(model.hold.length).fill(0);
  if (hold <= 0) return [...cubicWeights(model.press.map(Math.log), Math.log(share)), ...none];
  const grid = [0, ...model.hold.map(held)];
  return [...new Array(press - 1).fill(0), ...cubicWeights(grid, held(hold))];
}

function interp(x, xs, ys, beyond) {
  if (x >= xs[xs.length - 1]) return x > xs[xs.length - 1] && beyond !== undefined ? beyond : ys[ys.length - 1];
  if (x <= xs[0]) return ys[0];
  let k = 1;
  while (xs[k] < x) k++;
  return ys[k - 1] + (ys[k] - ys[k - 1]) * (x - xs[k - 1]) / (xs[k] - xs[k - 1]);
}

// A quantity at every moment: flat, moments first.
function quantity(name, terms) {
  const group = model.groups[name], found = group.mean.slice();
  group.rows.forEach((row, part) => {
    let score = 0;
    for (let t = 0; t < terms.length; t++) score += terms[t] * group.coefficients[t][part];
    for (let k = 0; k < found.length; k++) found[k] += score * row[k];
  });
  return found;
}

function atMoment(flat, weights) {
  const size = flat.length / weights.length, found = new Array(size).fill(0);
  weights.forEach((w, m) => { if (w) for (let k = 0; k < size; k++) found[k] += w * flat[m * size + k]; });
  return found;
}

// The layer, counted from 0 at the skin, that holds the receptors of each depth.
function layers(own, depths) {
  const at = key => {
    const k = model.knobs.findIndex(knob => knob.key === key);
    return k < 0 ? model.thicknesses[key] : own[k];
  };
  const ends = model.borders.map(keys => keys.reduce((sum, key) => sum + at(key), 0));
  return depths.map(depth => ends.filter(end => end < depth + model.on_border).length);
}

// Numbers of a list; energies of a layer that too few scenes had are none.
const known = values => values.filter(Number.isFinite);

// Energies jump where layers meet: of each depth the part whose layer holds its receptors, joined.
function joinEnergies(found, own) {
  const all = model.grids.receptor_depth, depths = [...new Set(all)].sort((a, b) => a - b);
  const holds = layers(own, depths);
  for (const end of ["", "_band"]) {
    const rows = end ? [0] : found.time;
    const joined = rows.map(() => all.map(() => NaN));
    for (const [name, [depth, layer]] of Object.entries(model.pieces)) {
      if (holds[depth] !== layer) continue;
      const places = all.map((d, k) => k).filter(k => all[k] === depths[depth]);
      const values = end ? [found[name + end]] : found[name];
      values.forEach((row, m) => places.forEach((k, j) => { joined[m][k] = row[j]; }));
    }
    found["energy_root" + end] = end ? joined[0] : joined;
  }
}

// The answer to { values: {key: SI value}, modulus, hold }.
function answer(state) {
  const own = model.knobs.map(k => state.values[k.key] / (k.key === FORCE || k.key === RATE ? state.modulus : 1));
  const outside = model.knobs.filter((k, i) => own[i] < k.low * (1 - 1e-9) || own[i] > k.high * (1 + 1e-9));
  const point = model.knobs.map((k, i) => scaled(k, own[i])), known = {};
  const flat = {}, top = state.values[FORCE] / state.values[RATE];
  for (const name of Object.keys(model.groups)) {
    const scales = model.groups[name].scales;
    known[scales] = known[scales] || terms(point, scales);
    flat[name] = quantity(name, known[scales]);
  }
  const holds = model.hold.filter(t => t < state.hold * (1 - 1e-9));
  if (state.hold > 0) holds.push(state.hold);
  const moments = [...model.press.map(share => ({ share, hold: 0 })), ...holds.map(hold => ({ share: 1, hold }))];
  const weights = moments.map(m => momentWeights(m.share, m.hold));
  const found = { outside, time: moments.map(m => top * m.share + m.hold), leg: moments.map(m => +(m.hold > 0)) };
  const size = name => (model.groups[name].stress ? state.modulus : 1);
  const last = weights[weights.length - 1], near = last.map(w => Math.max(w, 0));
  const sum = near.reduce((a, b) => a + b, 0), even = near.map(w => w / sum);
  for (const name of Object.keys(model.groups)) {
    const group = model.groups[name];
    if (name === "estimated_error") { found[name] = Math.exp(flat[name][0]); continue; }
    const over = values => (group.logarithmic ? values.map(v => Math.exp(v) * size(name)) : values);
    found[name] = weights.map(w => over(atMoment(flat[name], w)));
    const band = atMoment(group.band, even);
    found[name + "_band"] = group.logarithmic ? band.map(Math.expm1) : band;
  }
  found.peak_pressure = found.peak_pressure.map(([peak], m) => [Math.max(peak, found.centre_pressure[m][0])]);
  joinEnergies(found, own);
  const loads = moments.map(m => m.share * state.values[FORCE] / state.modulus / model.contact_length);
  found.strain_energy_density = found.energy_root.map((row, m) => row.map(r => state.modulus * (r * loads[m]) ** 2));
  const roots = found.energy_root[moments.length - 1].map(Math.abs);
  const widths = found.energy_root_band.map((b, k) => (model.turned ? b * roots[k] : b));
  found.strain_energy_density_band = widths.map((b, k) => b * (2 * roots[k] + b) / roots[k] ** 2);
  found.load = state.values[FORCE] / model.contact_length;
  found.rate = rates(found);
  return found;
}

// numpy.gradient of a trace.
function gradient(values, time) {
  const n = values.length, found = [];
  for (let k = 0; k < n; k++) {
    if (k === 0 || k === n - 1) {
      const a = k === 0 ? 0 : n - 2;
      found.push((values[a + 1] - values[a]) / (time[a + 1] - time[a]));
    } else {
      const h = time[k] - time[k - 1], g = time[k + 1] - time[k];
      found.push((h * h * values[k + 1] + (g * g - h * h) * values[k] - g * g * values[k - 1]) / (h * g * (h + g)));
    }
  }
  return found;
}

function receptor(depth, offset) {
  const d = model.grids.receptor_depth, o = model.grids.receptor_offset;
  return d.findIndex((v, k) => Math.abs(v - depth) < 1e-7 && Math.abs(o[k] - offset) < 1e-7);
}

// Impulse rate under the middle, leg by leg: [{ time, rate }]; the top of the press is there twice.
function rates(found) {
  const law = model.law, depths = STEADY_DEPTHS.filter(d => receptor(d, 0) >= 0);
  const which = receptor(depths.length ? depths[0] : model.grids.receptor_depth[0], 0);
  const energy = [0, ...found.strain_energy_density.map(row => row[which])];
  const time = [0, ...found.time], leg = [0, ...found.leg], out = [];
  const top = leg.lastIndexOf(0);
  for (const [a, b] of [[0, top], [top, time.length - 1]]) {
    if (b <= a) continue;
    const e = energy.slice(a, b + 1), t = time.slice(a, b + 1), change = gradient(e, t);
    e.forEach((v, k) => out.push({
      time: t[k],
      rate: law.per_energy * Math.max(v - law.threshold, 0) +
        law.per_rate * Math.max(change[k] - law.rate_threshold, 0) + law.spontaneous,
    }));
  }
  return out;
}

// Times at which the integral of the rate passes whole numbers.
function impulses(trace) {
  const found = [];
  let grown = 0, due = 1;
  for (let k = 1; k < trace.length; k++) {
    const dt = trace[k].time - trace[k - 1].time, a = trace[k - 1].rate, b = trace[k].rate;
    const more = dt * (a + b) / 2, slope = dt > 0 ? (b - a) / dt : 0;
    while (dt > 0 && due <= grown + more) {
      const need = due - grown;
      const root = a + Math.sqrt(Math.max(a * a + 2 * slope * need, 0));
      found.push(trace[k - 1].time + (root > 0 ? Math.min(2 * need / root, dt) : 0));
      due += 1;
    }
    grown += more;
  }
  return found;
}

// --- the knobs -----------------------------------------------------------------------------------

const LONGEST = model.hold[model.hold.length - 1];
const state = { values: {}, modulus: 1, hold: Math.min(1, LONGEST) };
const controls = [];
const STEPS = 1000;

function number(value) { return Number(value.toPrecision(6)); }

// A knob: its control moves from 0 to STEPS, evenly in the value, or in its logarithm.
function addKnob(id, label, unit, low, high, even, read, write) {
  const form = document.getElementById("knobs");
  const holder = document.createElement("label"), words = document.createElement("span");
  const name = document.createElement("span"), shown = document.createElement("output");
  const input = document.createElement("input");
  Object.assign(input, { type: "range", min: 0, max: STEPS, step: 1, id });
  name.textContent = label;
  holder.htmlFor = id; // not the output, which comes first
  words.append(name, shown);
  holder.append(words, input);
  form.append(holder);
  const to = even ? s => low + (high - low) * s / STEPS : s => low * Math.pow(high / low, s / STEPS);
  const from = even ? v => STEPS * (v - low) / (high - low) : v => STEPS * Math.log(v / low) / Math.log(high / low);
  const control = {
    show() {
      const text = `${Number(read().toPrecision(4))} ${unit}`.trim();
      shown.textContent = text;
      input.value = Math.round(from(read()));
      input.setAttribute("aria-valuetext", text);
    },
  };
  input.addEventListener("input", () => {
    write(Math.min(Math.max(number(to(+input.value)), low), high));
    draw();
  });
  controls.push(control);
}

function start() {
  for (const knob of model.knobs) {
    const low = knob.low / knob.per_unit, high = knob.high / knob.per_unit;
    const even = knob.key === CURVE || high / low < 5;
    addKnob(`knob-${knob.name}`, knob.label, knob.unit === "1" ? "" : knob.unit, low, high, even,
      () => state.values[knob.key] / knob.per_unit, v => { state.values[knob.key] = v * knob.per_unit; });
    state.values[knob.key] = knob.per_unit * number(even ? (low + high) / 2 : Math.sqrt(low * high));
  }
  const { low, high } = model.modulus;
  addKnob("knob-modulus", "Factor of all moduli", "", low, high, false, () => state.modulus, v => { state.modulus = v; });
  addKnob("knob-hold", "Length of the hold", "s", 0, LONGEST, true,
    () => state.hold, v => { state.hold = v; });
  const wanted = { [FORCE]: 20 * 9.80665e-3, [RATE]: 40 * 9.80665e-3, [CURVE]: 209.97 };
  for (const knob of model.knobs) if (within(knob, wanted[knob.key])) state.values[knob.key] = wanted[knob.key];
  for (const knob of model.knobs) {
    const usual = at(model.base, path(knob.key));
    if (!(knob.key in wanted) && within(knob, usual)) state.values[knob.key] = usual;
  }
  for (const [name, curvature] of model.surfaces) addSurface(name, curvature);
  for (const subject of model.subjects) addSubject(subject);
  if (!model.subjects.length) for (const id of ["subjects", "measured"]) document.getElementById(id).remove();
  readLink();
  document.getElementById("scenes").textContent = model.scenes;
  document.getElementById("shape").textContent = model.base.stimulus.shape;
  document.getElementById("copy").addEventListener("click", copy);
  window.addEventListener("hashchange", () => { readLink(); draw(); });
  draw();
}

const within = (knob, value) => value >= knob.low && value <= knob.high;
const path = key => key.replace(/\[/g, ".").replace(/\]/g, "").split(".");
const at = (part, words) => words.reduce((of, word) => (of === undefined ? of : of[word]), part);

function addSurface(name, curvature) {
  const knob = model.knobs.find(k => k.key === CURVE), button = document.createElement("button");
  const value = Math.max(curvature, knob.low < 0.05 ? knob.low : curvature);
  if (!within(knob, value)) return;
  button.type = "button";
  button.textContent = name;
  button.addEventListener("click", () => { state.values[CURVE] = value; draw(); });
  document.getElementById("surfaces").append(button);
  controls.push({ show() { button.setAttribute("aria-pressed", state.values[CURVE] === value); } });
}

// A measured finger: a flat plate, held as long as it goes, and its factor of the moduli.
function addSubject(subject) {
  const button = document.createElement("button"), knob = model.knobs.find(k => k.key === CURVE);
  button.type = "button";
  button.textContent = `subject ${subject.subject}`;
  button.addEventListener("click", () => {
    state.values[CURVE] = knob.low;
    state.modulus = subject.modulus;
    state.hold = LONGEST;
    draw();
  });
  document.getElementById("subjects").append(button);
  controls.push({ show() { button.setAttribute("aria-pressed", isOf(subject)); } });
}

const isOf = subject => state.modulus === subject.modulus && state.values[CURVE] <= model.flat;

function readLink() {
  for (const [key, text] of new URLSearchParams(location.hash.slice(1))) {
    const value = Number(text), knob = model.knobs.find(k => k.name === key);
    if (!Number.isFinite(value)) continue;
    if (knob && within(knob, value * knob.per_unit)) state.values[knob.key] = value * knob.per_unit;
    if (key === "modulus" && value >= model.modulus.low && value <= model.modulus.high) state.modulus = value;
    if (key === "hold" && value >= 0 && value <= LONGEST) state.hold = value;
  }
}

function link() {
  const words = model.knobs.map(k => [k.name, number(state.values[k.key] / k.per_unit)]);
  return "#" + new URLSearchParams([...words, ["modulus", state.modulus], ["hold", state.hold]]);
}

// The scene of the knobs: YAML, of which JSON is a part.
function sceneText() {
  const base = model.base, scene = { stimulus: { ...base.stimulus }, motion: [{}, {}], specimen: {} };
  for (const knob of model.knobs) {
    const words = path(knob.key), value = number(state.values[knob.key] / knob.per_unit);
    let part = scene;
    words.slice(0, -1).forEach(word => { part = part[word] = part[word] || {}; });
    part[words[words.length - 1]] = knob.unit === "1" ? value : `${value} ${knob.unit}`;
  }
  if (model.turned) scene.kinematics = "axisymmetric";
  scene.motion[1] = { hold: `${state.hold} s` };
  if (!(state.hold > 0)) scene.motion.pop();
  if (state.modulus !== 1) {
    const layers = scene.specimen.layers = {};
    for (const [name, layer] of Object.entries(base.specimen.layers)) {
      layers[name] = { youngs_modulus: `${layer.youngs_modulus * state.modulus} Pa`, poisson_ratio: layer.poisson_ratio };
    }
    scene.specimen.moduli = base.specimen.moduli;
  }
  if (!Object.keys(scene.specimen).length) delete scene.specimen;
  return Object.entries(scene).map(([key, part]) => `${key}: ${JSON.stringify(part)}`).join("\n") + "\n";
}

async function copy() {
  const pre = document.getElementById("scene"), button = document.getElementById("copy");
  try {
    await navigator.clipboard.writeText(pre.textContent);
    button.textContent = "Copied";
  } catch {
    getSelection().selectAllChildren(pre);
    button.textContent = "Selected: copy it with the keyboard";
  }
  setTimeout(() => { button.textContent = "Copy the scene"; }, 2000);
}

// --- numbers and pictures ------------------------------------------------------------------------

const LINES = ["var(--mark)", "var(--second)", "var(--third)", "var(--fourth)"];
const DASHES = ["", "7 3", "2 3", "9 3 2 3"];

function rows(found) {
  const last = found.indentation_depth.length - 1, list = [];
  const add = (label, name, k, scale, unit) => {
    const value = found[name][last][k] * scale;
    list.push({ label, name, value, band: value * found[name + "_band"][k], unit });
  };
  add("indentation depth", "indentation_depth", 0, 1e3, "mm");
  add("contact width", "contact_width", 0, 1e3, "mm");
  add("peak pressure", "peak_pressure", 0, 1e-3, "kPa");
  add("pressure in the middle", "centre_pressure", 0, 1e-3, "kPa");
  [...new Set(model.grids.receptor_depth)].forEach(depth => {
    const k = receptor(depth, 0);
    if (k >= 0) add(`strain energy at ${Math.round(depth * 1e6)} \u00b5m`, "strain_energy_density", k, 1, "Pa");
  });
  return list;
}

function draw() {
  const found = answer(state), whole = answer({ ...state, hold: LONGEST });
  const unknown = found.outside.length > 0, body = document.getElementById("numbers");
  controls.forEach(control => control.show());
  document.getElementById("note").textContent = unknown
    ? `${found.outside.map(k => k.label).join(" and ")}: outside what was simulated at this factor of the moduli. Nothing is known here.`
    : "";
  body.replaceChildren(...rows(found).map(row => {
    const line = document.createElement("tr"), head = document.createElement("th");
    head.scope = "row";
    head.textContent = row.label;
    const cells = [`${row.value.toPrecision(4)} ${row.unit}`, `\u00b1 ${row.band.toPrecision(2)} ${row.unit}`];
    line.append(head, ...cells.map(text => {
      const cell = document.createElement("td");
      cell.textContent = unknown || Number.isNaN(row.value) ? "\u2013" : text;
      return cell;
    }));
    return line;
  }));
  document.getElementById("elements").textContent =
    `The finite elements add an error of about ${(100 * found.estimated_error).toPrecision(2)} %.`;
  drawSection(found);
  if (model.subjects.length) drawForce();
  drawPressure(found);
  drawEnergy(found);
  drawTime(found, whole);
  drawRate(whole, found.time[found.time.length - 1]);
  document.getElementById("figures").style.opacity = unknown ? 0.35 : 1;
  document.getElementById("scene").textContent = sceneText();
  document.getElementById("link").href = link();
}

function shape(tag, attributes, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

const points = list => list.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ");

// A rounded step of an axis: 1, 2 or 5 times a power of ten.
function step(range) {
  const raw = range / 4, power = Math.pow(10, Math.floor(Math.log10(raw)));
  return power * [1, 2, 5, 10].find(k => k * power >= raw);
}

// Axes of a picture; gives the functions from values to places.
function axes(id, [x0, x1], [y0, y1], xLabel, yLabel) {
  const svg = document.getElementById(id), left = 52, right = 390, top = 12, bottom = 178, made = [];
  y1 = y1 > y0 ? y1 : y0 + 1;
  const px = x => left + (right - left) * (x - x0) / (x1 - x0), py = y => bottom - (bottom - top) * (y - y0) / (y1 - y0);
  const dx = step(x1 - x0), dy = step(y1 - y0);
  for (let x = Math.ceil(x0 / dx) * dx; x <= x1 * (1 + 1e-9); x += dx) {
    made.push(shape("text", { x: px(x), y: bottom + 15, "text-anchor": "middle" }, Number(x.toPrecision(6))));
  }
  for (let y = Math.ceil(y0 / dy) * dy; y <= y1 * (1 + 1e-9); y += dy) {
    made.push(shape("line", { x1: left, x2: right, y1: py(y), y2: py(y), stroke: "var(--line)", "stroke-width": 0.3 }));
    made.push(shape("text", { x: left - 5, y: py(y) + 4, "text-anchor": "end" }, Number(y.toPrecision(6))));
  }
  made.push(shape("polyline", { points: points([[left, top], [left, bottom], [right, bottom]]), fill: "none", stroke: "var(--line)" }));
  made.push(shape("text", { x: (left + right) / 2, y: bottom + 34, "text-anchor": "middle" }, xLabel));
  made.push(shape("text", { x: 12, y: (top + bottom) / 2, "text-anchor": "middle", transform: `rotate(-90 12 ${(top + bottom) / 2})` }, yLabel));
  svg.replaceChildren(...made);
  const line = (list, k = 0) => svg.append(shape("polyline", { points: points(list.map(([x, y]) => [px(x), py(y)])),
    fill: "none", stroke: LINES[k % 4], "stroke-width": 2, "stroke-dasharray": DASHES[k % 4] }));
  const band = (low, high) => svg.append(shape("polygon", { fill: "var(--band)",
    points: points([...low, ...high.slice().reverse()].map(([x, y]) => [px(x), py(y)])) }));
  return { svg, px, py, line, band };
}

function describe(id, text) { document.getElementById(id).setAttribute("aria-label", text); }

function drawSection(found) {
  const svg = document.getElementById("section"), last = found.indentation_depth.length - 1;
  const depth = found.indentation_depth[last][0], { arc, skin_x: restX, skin_y: restY } = model.grids;
  const right = arc.map((_, k) => [restX[k] + depth * found.skin_displacement_x[last][k], restY[k] + depth * found.skin_displacement_y[last][k]]);
  const skin = [...right.slice(1).reverse().map(([x, y]) => [-x, y]), ...right];
  const scale = 400 / 13e-3, px = x => 200 + x * scale, py = y => 70 + (restY[0] - y) * scale;
  const curvature = state.values[CURVE], tip = restY[0] - depth, solid = [];
  for (let k = 0; k <= 120; k++) {
    const x = -6.4e-3 + 12.8e-3 * k / 120, root = 1 - (x * curvature) ** 2;
    if (root > 0) solid.push([px(x), py(tip + (1 - Math.sqrt(root)) / Math.max(curvature, 1e-9))]);
  }
  const ends = [[solid[solid.length - 1][0], -20], [solid[0][0], -20]];
  const energies = found.strain_energy_density[last], most = Math.max(...known(energies)), discs = [];
  energies.forEach((energy, k) => {
    if (!Number.isFinite(energy)) return;
    const d = model.grids.receptor_depth[k], x = model.grids.receptor_offset[k];
    for (const side of x > 0 ? [-1, 1] : [1]) {
      discs.push(shape("circle", { cx: px(side * interp(x, restX, right.map(p => p[0]))), cy: py(interp(x, restX, right.map(p => p[1])) - d), r: 1.5 + 9 * Math.sqrt(energy / most),
        fill: "var(--second)", "fill-opacity": 0.75 }));
    }
  });
  svg.replaceChildren(
    shape("polygon", { points: points([...skin.map(([x, y]) => [px(x), py(y)]), [400, 270], [0, 270]]), fill: "var(--skin)", "fill-opacity": 0.25 }),
    shape("polyline", { points: points(skin.map(([x, y]) => [px(x), py(y)])), fill: "none", stroke: "var(--skin)", "stroke-width": 2.5 }),
    ...discs,
    shape("polygon", { points: points([...solid, ...ends]), fill: "var(--solid)", stroke: "var(--ink)" }),
    shape("line", { x1: 20, x2: 20 + 1e-3 * scale, y1: 245, y2: 245, stroke: "var(--ink)", "stroke-width": 3 }),
    shape("text", { x: 20, y: 237 }, "1 mm"));
  describe("section", `Section of the pad: the surface has sunk ${(depth * 1e3).toPrecision(3)} mm into it.`);
}

// Depth (m) at the end of the hold under a force (N).
function depthUnder(force) {
  const own = model.knobs.map(k => (k.key === FORCE ? force : state.values[k.key]) / (k.key === FORCE || k.key === RATE ? state.modulus : 1));
  const group = model.groups.indentation_depth, point = model.knobs.map((k, i) => scaled(k, own[i]));
  return Math.exp(atMoment(quantity("indentation_depth", terms(point, group.scales)), momentWeights(1, state.hold))[0]);
}

function drawForce() {
  const knob = model.knobs.find(k => k.key === FORCE), now = state.values[FORCE], count = 16;
  const low = knob.low * state.modulus, high = Math.min(knob.high * state.modulus, Math.max(1.1, now));
  const curve = Array.from({ length: count + 1 }, (_, k) => low * Math.pow(high / low, k / count)).map(f => [depthUnder(f) * 1e3, f]);
  const depths = model.subjects.flatMap(s => s.points.map(p => p[1] * 1e3));
  const picture = axes("force", [0, Math.max(...depths, curve[count][0]) * 1.05], [0, high * 1.05], "depth (mm)", "force (N)");
  picture.line(curve);
  for (const subject of model.subjects) {
    for (const [force, depth] of subject.points) {
      picture.svg.append(shape("circle", { cx: picture.px(depth * 1e3), cy: picture.py(force), r: isOf(subject) ? 5 : 3,
        fill: isOf(subject) ? "var(--second)" : "none", stroke: "var(--second)" }));
    }
  }
  const forces = model.subjects.flatMap(s => s.points.map(p => p[0]));
  const most = Math.max(...forces), least = Math.min(...forces);
  const left = [];
  if (state.values[CURVE] > model.flat) left.push("the surface is not flat");
  if (now > most || now < least) left.push("the force lies outside them");
  if (state.hold < LONGEST) left.push("the hold is short");
  document.getElementById("beyond").textContent =
    `Measured: a plate at rest, ${least.toPrecision(2)} to ${most.toPrecision(3)} N (${model.subjects[0].source}).` +
    (left.length ? ` These knobs leave the measurements: ${left.join(", ")}.` : "");
  describe("force", `Force against depth, under ${now.toPrecision(3)} N ${(depthUnder(now) * 1e3).toPrecision(3)} mm; points are measured fingers under a plate.`);
}

function drawPressure(found) {
  const last = found.indentation_depth.length - 1, half = found.contact_width[last][0] / 2;
  const mean = found.load / (model.turned ? Math.PI * half * half : 2 * half);
  const shapeOf = found.pressure_shape[last], width = found.pressure_shape_band;
  const side = sign => (v, k) => [v * half * 1e3, Math.max(shapeOf[k] + sign * width[k], 0) * mean / 1e3];
  const both = list => [...list.slice(1).reverse().map(([x, y]) => [-x, y]), ...list];
  const middle = both(model.places.map(side(0))), low = both(model.places.map(side(-1))), high = both(model.places.map(side(1)));
  const reach = Math.max(half * 1.2e3, 0.5), most = Math.max(...high.map(p => p[1])) * 1.05;
  const picture = axes("pressure", [-reach, reach], [0, most], "place (mm)", "pressure (kPa)");
  picture.band(low, high);
  picture.line([[-reach, 0], [-half * 1e3, 0], ...middle, [half * 1e3, 0], [reach, 0]]);
  describe("pressure", `Pressure over a contact ${(2e3 * half).toPrecision(3)} mm wide, in the middle ${(shapeOf[0] * mean / 1e3).toPrecision(3)} kPa.`);
}

function drawEnergy(found) {
  const last = found.indentation_depth.length - 1, energies = found.strain_energy_density[last], band = found.strain_energy_density_band;
  const { receptor_depth: depths, receptor_offset: offsets } = model.grids, lines = [...new Set(depths)];
  const most = Math.max(...known(energies.map((e, k) => e * (1 + band[k]))));
  const picture = axes("energy", [0, Math.max(...offsets) * 1e3 || 1], [0, most], "distance from the middle (mm)", "strain energy (Pa)");
  lines.forEach((depth, n) => {
    const own = depths.map((d, k) => k).filter(k => depths[k] === depth && Number.isFinite(energies[k]));
    if (!own.length) return;
    picture.band(own.map(k => [offsets[k] * 1e3, energies[k] * (1 - Math.min(band[k], 1))]), own.map(k => [offsets[k] * 1e3, energies[k] * (1 + band[k])]));
    picture.line(own.map(k => [offsets[k] * 1e3, energies[k]]), n);
    picture.svg.append(shape("line", { x1: 285, x2: 315, y1: 20 + 16 * n, y2: 20 + 16 * n, stroke: LINES[n % 4], "stroke-width": 2, "stroke-dasharray": DASHES[n % 4] }),
      shape("text", { x: 320, y: 24 + 16 * n }, `${Math.round(depth * 1e6)} \u00b5m`));
  });
  describe("energy", `Strain energy under the skin, at most ${Math.max(...known(energies)).toPrecision(3)} Pa.`);
}

function marker(picture, time) {
  picture.svg.append(shape("line", { x1: picture.px(time), x2: picture.px(time), y1: 12, y2: 178, stroke: "var(--ink)", "stroke-dasharray": "3 3" }));
}

function drawTime(found, whole) {
  const depths = [...new Set(model.grids.receptor_depth)], end = whole.time[whole.time.length - 1];
  const traces = depths.map(d => whole.strain_energy_density.map(row => row[receptor(d, 0)]));
  const picture = axes("time", [0, end], [0, Math.max(...known(traces.flat()))], "time (s)", "strain energy (Pa)");
  traces.forEach((trace, k) => Number.isFinite(trace[0]) && picture.line([[0, 0], ...trace.map((e, m) => [whole.time[m], e])], k));
  marker(picture, found.time[found.time.length - 1]);
  describe("time", "Strain energy under the middle over time, a line each depth.");
}

function drawRate(whole, now) {
  const trace = whole.rate, ticks = impulses(trace), end = trace[trace.length - 1].time;
  const most = Math.max(...trace.map(p => p.rate), 1);
  const picture = axes("rate", [0, end], [0, most * 1.25], "time (s)", "rate (impulses/s)");
  picture.line(trace.map(p => [p.time, p.rate]));
  for (const t of ticks) {
    picture.svg.append(shape("line", { x1: picture.px(t), x2: picture.px(t), y1: 14, y2: 28, stroke: "var(--ink)", "stroke-opacity": t <= now ? 1 : 0.35 }));
  }
  marker(picture, now);
  describe("rate", `Predicted rate, at most ${most.toPrecision(3)} impulses a second, and ${ticks.filter(t => t <= now).length} impulses.`);
}

start();
