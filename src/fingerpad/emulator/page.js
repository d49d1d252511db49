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
  return trend.concat(kernel(point, scales));
}

function kernel(point, scales) {
  return model.centres.map(centre => {
    const far = Math.sqrt(5) * Math.hypot(...centre.map((c, k) => (point[k] - c) / scales[k]));
    return (1 + far + far * far / 3) * Math.exp(-far);
  });
}

// By how much scenes nearby are missed, over what is usual: the band is so much wider.
function localSize(near, missed) {
  let weights = 0, around = 0, all = 0, count = 0;
  missed.forEach((miss, k) => {
    if (!Number.isFinite(miss)) return;
    weights += near[k];
    around += near[k] * miss ** 2;
    all += miss ** 2;
    count += 1;
  });
  return Math.sqrt((1 - model.from_all) * around / Math.max(weights, 1e-300) + model.from_all * all / count);
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

// Depths at which layers end.
function layerEnds(own) {
  const at = key => {
    const k = model.knobs.findIndex(knob => knob.key === key);
    return k < 0 ? model.thicknesses[key] : own[k];
  };
  return model.borders.map(keys => keys.reduce((sum, key) => sum + at(key), 0));
}

// The layer, counted from 0 at the skin, that holds the receptors of each depth.
function layers(own, depths) {
  const ends = layerEnds(own);
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
  const last = weights[weights.length - 1].map(w => Math.max(w, 0));
  const sum = last.reduce((a, b) => a + b, 0), even = last.map(w => w / sum);
  const near = kernel(point, model.knobs.map(() => model.nearby));
  for (const name of Object.keys(model.groups)) {
    const group = model.groups[name];
    if (name === "estimated_error") { found[name] = Math.exp(flat[name][0]); continue; }
    const over = values => (group.logarithmic ? values.map(v => Math.exp(v) * size(name)) : values);
    found[name] = weights.map(w => over(atMoment(flat[name], w)));
    const wider = localSize(near, group.missed), band = atMoment(group.band, even).map(b => b * wider);
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

// The receptor under the middle whose impulses are shown; undefined if there is none.
function steady() {
  return [...STEADY_DEPTHS, ...model.grids.receptor_depth].map(d => receptor(d, 0)).find(k => k >= 0);
}

// Impulse rate under the middle, leg by leg: [{ time, rate }]; the top of the press is there twice.
function rates(found) {
  const law = model.law, which = steady();
  if (which === undefined) return [];
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
const STEPS = 400;
const FIRST = [CURVE, FORCE, RATE, "modulus"]; // then thicknesses and others, then the hold
const GF = 9.80665e-3;

function number(value, digits = 6) { return Number(value.toPrecision(digits)); }

function made(tag, properties, ...inside) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...inside);
  return element;
}

// A knob is a slider and a box for its number. The slider moves from 0 to STEPS, evenly in the
// value, or in its logarithm. `also` tells the value in another unit.
function addKnob({ id, label, unit = "", low, high, even, read, write, also = () => "", hint = "" }) {
  const input = made("input", { type: "range", min: 0, max: STEPS, step: 1, id });
  const box = made("input", { type: "number", step: 10 ** Math.floor(Math.log10((high - low) / 50)), id: id + "-box" });
  box.setAttribute("aria-label", `${label}${unit && ", " + unit}, a number from ${number(low, 4)} to ${number(high, 4)}`);
  const other = made("span", {});
  const holder = made("div", { className: "knob" }, made("label", { htmlFor: id }, label), made("span", {}, box, ` ${unit}`, other), input);
  if (hint) {
    holder.append(made("small", { id: id + "-hint" }, hint));
    input.setAttribute("aria-describedby", id + "-hint");
  }
  document.getElementById("note").before(holder);
  const to = even ? s => low + (high - low) * s / STEPS : s => low * Math.pow(high / low, s / STEPS);
  const from = even ? v => STEPS * (v - low) / (high - low) : v => STEPS * Math.log(v / low) / Math.log(high / low);
  let typing = false;
  const turn = value => { write(Math.min(Math.max(number(value), low), high)); draw(); };
  input.addEventListener("input", () => turn(number(to(+input.value), 4)));
  box.addEventListener("input", () => {
    typing = true; // leave what is written, such as "40" on the way to "400"
    if (box.valueAsNumber >= low && box.valueAsNumber <= high) turn(box.valueAsNumber);
    typing = false;
  });
  box.addEventListener("change", () => turn(Number.isFinite(box.valueAsNumber) ? box.valueAsNumber : read()));
  controls.push({
    show() {
      if (!typing) box.value = number(read());
      input.value = Math.round(from(read()));
      other.textContent = also();
      input.setAttribute("aria-valuetext", `${number(read(), 4)} ${unit} ${also()}`.trim());
    },
  });
}

function start() {
  const knobs = [];
  for (const knob of model.knobs) {
    const low = knob.low / knob.per_unit, high = knob.high / knob.per_unit;
    const even = knob.key === CURVE || high / low < 5;
    const other = () => knob.unit === "gf" ? ` = ${plain(state.values[FORCE], 3)}\u00a0N` : ` = ${plain(state.values[FORCE] / GF, 3)}\u00a0gf`;
    knobs.push({ key: knob.key, id: `knob-${knob.name}`, label: knob.label, unit: knob.unit === "1" ? "" : knob.unit, low, high, even,
      read: () => state.values[knob.key] / knob.per_unit, write: v => { state.values[knob.key] = v * knob.per_unit; },
      also: knob.key === FORCE ? other : undefined });
    state.values[knob.key] = knob.per_unit * number(even ? (low + high) / 2 : Math.sqrt(low * high));
  }
  knobs.push({ key: "modulus", id: "knob-modulus", label: "Stiffness (1 = usual)", ...model.modulus, even: false,
    read: () => state.modulus, write: v => { state.modulus = v; }, hint: "2: every layer twice as stiff" });
  const place = knob => (FIRST.includes(knob.key) ? FIRST.indexOf(knob.key) : FIRST.length);
  knobs.sort((a, b) => place(a) - place(b)).forEach(addKnob);
  addKnob({ id: "knob-hold", label: "Length of hold", unit: "s", low: 0, high: LONGEST, even: true,
    read: () => state.hold, write: v => { state.hold = v; } });
  const wanted = { [FORCE]: 20 * GF, [RATE]: 40 * GF, [CURVE]: 209.97 };
  for (const knob of model.knobs) if (within(knob, wanted[knob.key])) state.values[knob.key] = wanted[knob.key];
  for (const knob of model.knobs) {
    const usual = at(model.base, path(knob.key));
    if (!(knob.key in wanted) && within(knob, usual)) state.values[knob.key] = usual;
  }
  for (const [name, curvature] of model.surfaces) addSurface(name, curvature);
  for (const subject of model.subjects) addSubject(subject);
  const away = [];
  if (!model.subjects.length) away.push("force");
  if (new Set(model.grids.receptor_offset).size < 2) away.push("energy");
  if (steady() === undefined) {
    away.push("time", "rate");
    document.getElementById("under").remove();
  } else {
    document.getElementById("which").textContent = `Its receptor is ${micrometres(model.grids.receptor_depth[steady()])} deep, under the middle of the contact.`;
  }
  for (const id of away) document.getElementById(id).parentElement.remove(); // there is nothing to draw
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

// A measured finger: a flat plate, held as long as it goes, and its stiffness.
function addSubject(subject) {
  const button = document.createElement("button"), knob = model.knobs.find(k => k.key === CURVE);
  button.type = "button";
  button.textContent = `finger ${subject.subject}`;
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
const FASTEST = 300; // impulses/s

// A number to some digits, never with an exponent.
const formats = {};
function plain(value, digits) {
  formats[digits] = formats[digits] || new Intl.NumberFormat("en", { useGrouping: false, minimumSignificantDigits: digits, maximumSignificantDigits: digits });
  return formats[digits].format(value);
}

const micrometres = depth => `${Math.round(depth * 1e6)}\u00a0\u00b5m`;

// A unit for pressures up to a largest one.
const pascals = most => (most >= 1000 ? { scale: 1e-3, unit: "kPa" } : { scale: 1, unit: "Pa" });
const largest = values => Math.max(0, ...known(values));

function rows(found) {
  const last = found.indentation_depth.length - 1, list = [];
  const add = (label, name, k, { scale, unit }) => {
    const value = found[name][last][k] * scale;
    list.push({ label, name, value, band: value * found[name + "_band"][k], unit });
  };
  const mm = { scale: 1e3, unit: "mm" }, pressure = pascals(found.peak_pressure[last][0]);
  add("indentation depth", "indentation_depth", 0, mm);
  add("contact width", "contact_width", 0, mm);
  add("peak pressure", "peak_pressure", 0, pressure);
  add("pressure in the middle", "centre_pressure", 0, pressure);
  const middle = [...new Set(model.grids.receptor_depth)].filter(depth => receptor(depth, 0) >= 0);
  const energy = pascals(largest(middle.map(depth => found.strain_energy_density[last][receptor(depth, 0)])));
  for (const depth of middle) add(`strain energy density at ${micrometres(depth)}`, "strain_energy_density", receptor(depth, 0), energy);
  return list;
}

function drawNumbers(found) {
  const unknown = found.outside.length > 0;
  document.getElementById("numbers").replaceChildren(...rows(found).map(row => {
    const none = unknown || !Number.isFinite(row.value);
    const cells = [`${plain(row.value, 4)}\u00a0${row.unit}`, `\u00b1\u00a0${plain(row.band, 2)}\u00a0${row.unit}`];
    return made("tr", {}, made("th", { scope: "row" }, row.label), ...cells.map(text => made("td", {}, none ? "\u2013" : text)));
  }));
  document.getElementById("elements").textContent = unknown ? ""
    : `The simulations themselves are wrong by about ${plain(100 * found.estimated_error, 2)}\u00a0%, as their mesh is not infinitely fine.`;
}

// What to do where nothing was simulated: the range of each knob that leaves the box.
function advice(outside) {
  const ranges = outside.map(knob => {
    const low = knob.low * Math.max(state.modulus, 1), high = knob.high * Math.min(state.modulus, 1);
    return `${knob.label} from ${number(low / knob.per_unit, 3)} to ${number(high / knob.per_unit, 3)}\u00a0${knob.unit}`;
  });
  return outside.length ? `Unknown: not simulated. At stiffness ${number(state.modulus, 3)}, use ${ranges.join(" and ")}.` : "";
}

function draw() {
  const found = answer(state), whole = answer({ ...state, hold: LONGEST });
  const unknown = found.outside.length > 0;
  controls.forEach(control => control.show());
  document.getElementById("note").textContent = advice(found.outside);
  drawNumbers(found);
  const pictures = { section: drawSection, force: drawForce, pressure: drawPressure, energy: drawEnergy, time: drawTime, rate: drawRate };
  for (const [id, drawIt] of Object.entries(pictures)) {
    const svg = document.getElementById(id);
    if (!svg) continue;
    drawIt(found, whole);
    svg.classList.toggle("unknown", unknown);
    if (!unknown) continue;
    svg.append(shape("text", { x: 220, y: 140, "text-anchor": "middle", class: "outside" }, "Unknown: not simulated"));
    describe(id, "Unknown: not simulated.");
  }
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

const ink = k => ({ fill: "none", stroke: LINES[k % 4], "stroke-width": 2, "stroke-dasharray": DASHES[k % 4] });
const thin = { stroke: "var(--ink)", "stroke-dasharray": "3 3" };
const measuredDot = chosen => (x, y) => shape("circle", { cx: x, cy: y, r: chosen ? 5 : 3, fill: chosen ? "var(--second)" : "none", stroke: "var(--second)" });
const here = (x, y) => shape("circle", { cx: x, cy: y, r: 6, fill: "var(--mark)" });
const disc = (x, y, r) => shape("circle", { cx: x, cy: y, r, fill: "var(--second)", "fill-opacity": 0.75 });

// Samples of a legend: each draws itself with its middle at (x, y), at most 20 wide.
const sample = {
  line: look => (x, y) => shape("line", { x1: x - 10, x2: x + 10, y1: y, y2: y, ...look }),
  upright: look => (x, y) => shape("line", { x1: x, x2: x, y1: y - 7, y2: y + 7, ...look }),
  band: (x, y) => shape("rect", { x: x - 10, y: y - 5, width: 20, height: 10, fill: "var(--band)" }),
};

// Writes [text, sample] in lines from y on; gives the y under the last.
function legend(svg, items, y) {
  let x = 4;
  for (const [text, sampleAt] of items) {
    const width = 42 + 6.6 * text.length;
    if (x > 4 && x + width > 418) [x, y] = [4, y + 18];
    svg.append(sampleAt(x + 10, y + 8), shape("text", { x: x + 25, y: y + 12 }, text));
    x += width;
  }
  return items.length ? y + 18 : y;
}

const depthLegend = depths => depths.map((depth, k) => [micrometres(depth), sample.line(ink(k))]);
const END = ["end of the hold", sample.upright(thin)];

// Axes of a picture under its legend; gives the functions from values to places.
function axes(id, [x0, x1], [y0, y1], xLabel, yLabel, items) {
  const svg = document.getElementById(id), left = 48, right = 390, drawn = [];
  svg.replaceChildren(shape("text", { x: 4, y: 14 }, yLabel));
  const top = legend(svg, items, 20) + 8, bottom = top + 150;
  svg.setAttribute("viewBox", `0 0 400 ${bottom + 40}`);
  y1 = y1 > y0 ? y1 : y0 + 1;
  const px = x => left + (right - left) * (x - x0) / (x1 - x0), py = y => bottom - (bottom - top) * (y - y0) / (y1 - y0);
  const dx = step(x1 - x0), dy = step(y1 - y0);
  for (let x = Math.ceil(x0 / dx) * dx; x <= x1 * (1 + 1e-9); x += dx) {
    drawn.push(shape("text", { x: px(x), y: bottom + 16, "text-anchor": "middle" }, number(x)));
  }
  for (let y = Math.ceil(y0 / dy) * dy; y <= y1 * (1 + 1e-9); y += dy) {
    drawn.push(shape("line", { x1: left, x2: right, y1: py(y), y2: py(y), stroke: "var(--line)", "stroke-width": 0.3 }));
    drawn.push(shape("text", { x: left - 5, y: py(y) + 4, "text-anchor": "end" }, number(y)));
  }
  drawn.push(shape("polyline", { points: points([[left, top], [left, bottom], [right, bottom]]), fill: "none", stroke: "var(--line)" }));
  drawn.push(shape("text", { x: (left + right) / 2, y: bottom + 34, "text-anchor": "middle" }, xLabel));
  svg.append(...drawn);
  const line = (list, k = 0) => svg.append(shape("polyline", { points: points(list.map(([x, y]) => [px(x), py(y)])), ...ink(k) }));
  const band = (low, high) => svg.append(shape("polygon", { fill: "var(--band)",
    points: points([...low, ...high.slice().reverse()].map(([x, y]) => [px(x), py(y)])) }));
  const marker = x => svg.append(shape("line", { x1: px(x), x2: px(x), y1: top, y2: bottom, ...thin }));
  return { svg, px, py, top, line, band, marker };
}

function describe(id, text) { document.getElementById(id).setAttribute("aria-label", text); }

const border = k => ({ fill: "none", stroke: "var(--skin)", "stroke-width": 1.5, "stroke-dasharray": DASHES[1 + k % 3] });

// The name of the layer that ends under the thicknesses of these keys.
function layerName(keys) {
  const named = /(\w+)_thickness$/.exec(keys[keys.length - 1]);
  return named ? named[1].replace(/_/g, " ") : `layer ${keys.length}`;
}

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
  const corners = [[solid[solid.length - 1][0], -20], [solid[0][0], -20]];
  const ends = layerEnds(model.knobs.map(knob => state.values[knob.key]));
  const energies = found.strain_energy_density[last], most = largest(energies), discs = [];
  const radius = energy => 1.5 + 9 * Math.sqrt(energy / most);
  const under = depth => points(skin.map(([x, y]) => [px(x), py(y - depth)]));
  energies.forEach((energy, k) => {
    if (!Number.isFinite(energy)) return;
    const d = model.grids.receptor_depth[k], x = model.grids.receptor_offset[k];
    for (const side of x > 0 ? [-1, 1] : [1]) {
      const line = axis => interp(x, restX, right.map(p => p[axis]));
      discs.push(disc(px(side * line(0)), py(line(1) - d), radius(energy)));
    }
  });
  svg.replaceChildren(
    shape("polygon", { points: `${under(0)} 400,270 0,270`, fill: "var(--skin)", "fill-opacity": 0.25 }),
    shape("polyline", { points: under(0), fill: "none", stroke: "var(--skin)", "stroke-width": 2.5 }),
    ...ends.map((depth, k) => shape("polyline", { points: under(depth), ...border(k) })),
    ...discs,
    shape("polygon", { points: points([...solid, ...corners]), fill: "var(--solid)", stroke: "var(--ink)" }),
    shape("line", { x1: 20, x2: 20 + 1e-3 * scale, y1: 245, y2: 245, stroke: "var(--ink)", "stroke-width": 3 }),
    shape("text", { x: 20, y: 237 }, "1 mm"),
    shape("rect", { x: 0, y: 256, width: 400, height: 60, fill: "var(--back)" }));
  const items = model.borders.map((keys, k) => [`end of ${layerName(keys)}`, sample.line(border(k))]);
  if (most > 0) {
    const size = step(most), { scale: per, unit } = pascals(most);
    items.push([`disc: ${number(size * per)}\u00a0${unit}`, (x, y) => disc(x, y, radius(size))]);
  }
  svg.setAttribute("viewBox", `0 0 400 ${legend(svg, items, 260) + 4}`);
  describe("section", `Section of the pad: the surface has sunk ${plain(depth * 1e3, 3)} mm into it.`);
}

// Depth (m) at the end of the hold under a force (N).
function depthUnder(force) {
  const own = model.knobs.map(k => (k.key === FORCE ? force : state.values[k.key]) / (k.key === FORCE || k.key === RATE ? state.modulus : 1));
  const group = model.groups.indentation_depth, point = model.knobs.map((k, i) => scaled(k, own[i]));
  return Math.exp(atMoment(quantity("indentation_depth", terms(point, group.scales)), momentWeights(1, state.hold))[0]);
}

function drawForce(found) {
  const knob = model.knobs.find(k => k.key === FORCE), now = state.values[FORCE], depth = depthUnder(now) * 1e3, count = 16;
  const low = knob.low * state.modulus, high = Math.min(knob.high * state.modulus, Math.max(1.1, now));
  const curve = Array.from({ length: count + 1 }, (_, k) => low * Math.pow(high / low, k / count)).map(f => [depthUnder(f) * 1e3, f]);
  const measured = model.subjects.flatMap(subject => subject.points.map(([force, deep]) => ({ force, deep: deep * 1e3, chosen: isOf(subject) })));
  const forces = measured.map(p => p.force), most = Math.max(...forces), least = Math.min(...forces);
  const items = [["emulator", sample.line(ink(0))], ["this touch", here], ["measured fingers", measuredDot(false)]];
  if (measured.some(p => p.chosen)) items.push(["chosen finger", measuredDot(true)]);
  const reach = Math.max(...measured.map(p => p.deep), curve[count][0], depth);
  const picture = axes("force", [0, reach * 1.05], [0, Math.max(high, most, now) * 1.05], "depth (mm)", "force (N)", items);
  picture.line(curve);
  const points = measured.map(p => measuredDot(p.chosen)(picture.px(p.deep), picture.py(p.force)));
  points.forEach(point => point.classList.add("measured"));
  picture.svg.append(...points);
  if (!found.outside.length) picture.svg.append(here(picture.px(depth), picture.py(now)));
  const left = [];
  if (state.values[CURVE] > model.flat) left.push("the surface is not flat");
  if (now > most || now < least) left.push(`the force is not from ${plain(least, 2)} to ${plain(most, 3)}\u00a0N`);
  if (state.hold < LONGEST) left.push(`the hold is shorter than ${number(LONGEST, 3)}\u00a0s`);
  document.getElementById("beyond").textContent = `The fingers were measured at rest under a flat plate (${model.subjects[0].source}).` +
    (left.length ? ` Do not compare this touch with them: ${left.join(", ")}.` : "");
  describe("force", `Force against depth. This touch: ${plain(now, 3)} N, ${plain(depth, 3)} mm. Points are measured fingers under a plate.`);
}

function drawPressure(found) {
  const last = found.indentation_depth.length - 1, half = found.contact_width[last][0] / 2;
  const mean = found.load / (model.turned ? Math.PI * half * half : 2 * half);
  const shapeOf = found.pressure_shape[last], width = found.pressure_shape_band;
  const { scale, unit } = pascals(mean * Math.max(...shapeOf));
  const side = sign => (v, k) => [v * half * 1e3, Math.max(shapeOf[k] + sign * width[k], 0) * mean * scale];
  const both = list => [...list.slice(1).reverse().map(([x, y]) => [-x, y]), ...list];
  const middle = both(model.places.map(side(0))), low = both(model.places.map(side(-1))), high = both(model.places.map(side(1)));
  const reach = Math.max(half * 1.2e3, 0.5), most = Math.max(...high.map(p => p[1])) * 1.05;
  const picture = axes("pressure", [-reach, reach], [0, most], "place (mm)", `pressure (${unit})`,
    [["pressure", sample.line(ink(0))], ["band", sample.band]]);
  picture.band(low, high);
  picture.line([[-reach, 0], [-half * 1e3, 0], ...middle, [half * 1e3, 0], [reach, 0]]);
  describe("pressure", `Pressure over a contact ${plain(2e3 * half, 3)} mm wide, in the middle ${plain(shapeOf[0] * mean * scale, 3)} ${unit}.`);
}

function drawEnergy(found) {
  const last = found.indentation_depth.length - 1, energies = found.strain_energy_density[last], band = found.strain_energy_density_band;
  const { receptor_depth: depths, receptor_offset: offsets } = model.grids, lines = [...new Set(depths)];
  const most = largest(energies.map((e, k) => e * (1 + band[k]))), { scale, unit } = pascals(most);
  const picture = axes("energy", [0, Math.max(...offsets) * 1e3], [0, most * scale], "distance from the middle (mm)", `strain energy density (${unit})`,
    [...depthLegend(lines), ["band", sample.band]]);
  lines.forEach((depth, n) => {
    const own = depths.map((d, k) => k).filter(k => depths[k] === depth && Number.isFinite(energies[k]));
    const at = part => own.map(k => [offsets[k] * 1e3, energies[k] * scale * part(band[k])]);
    if (!own.length) return;
    picture.band(at(b => 1 - Math.min(b, 1)), at(b => 1 + b));
    picture.line(at(() => 1), n);
  });
  describe("energy", `Strain energy density under the skin, at most ${plain(largest(energies) * scale, 3)} ${unit}.`);
}

function drawTime(found, whole) {
  const depths = [...new Set(model.grids.receptor_depth)], end = whole.time[whole.time.length - 1];
  const traces = depths.map(d => whole.strain_energy_density.map(row => row[receptor(d, 0)]));
  const most = largest(traces.flat()), { scale, unit } = pascals(most);
  const picture = axes("time", [0, end], [0, most * scale], "time (s)", `strain energy density (${unit})`, [...depthLegend(depths), END]);
  traces.forEach((trace, k) => Number.isFinite(trace[0]) && picture.line([[0, 0], ...trace.map((e, m) => [whole.time[m], e * scale])], k));
  picture.marker(found.time[found.time.length - 1]);
  describe("time", `Strain energy density under the middle over time, at most ${plain(most * scale, 3)} ${unit}.`);
}

function drawRate(found, whole) {
  const trace = whole.rate, end = trace[trace.length - 1].time, now = found.time[found.time.length - 1];
  const most = largest(trace.map(p => p.rate)), fast = most > FASTEST, ticks = fast ? [] : impulses(trace);
  const items = [["rate", sample.line(ink(0))], ["one impulse", sample.upright({ stroke: "var(--ink)" })], END];
  const picture = axes("rate", [0, end], [0, Math.max(most, 1) * 1.25], "time (s)", "rate (impulses/s)", items);
  picture.line(trace.map(p => [p.time, p.rate]));
  for (const t of ticks) {
    picture.svg.append(shape("line", { x1: picture.px(t), x2: picture.px(t), y1: picture.top + 2, y2: picture.top + 16, stroke: "var(--ink)", "stroke-opacity": t <= now ? 1 : 0.35 }));
  }
  picture.marker(now);
  document.getElementById("fast").textContent = fast && !found.outside.length
    ? `Not real above ${FASTEST} impulses/s: no afferent fires that fast, and the law was fitted to small touches. Impulses are not drawn.` : "";
  const count = fast ? "" : ` ${ticks.filter(t => t <= now).length} impulses until the end of the hold.`;
  describe("rate", `Predicted rate, at most ${plain(most, 3)} impulses/s.${count}`);
}

start();
