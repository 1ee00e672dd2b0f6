// The model of the explorer: the state of the controls, and values by the printed functions.
// It does not need a page: tests run it in Node.

const STEPS = 160; // of a curve
const AVERAGE_STEPS = 60; // of a curve of averages, each of which is a sum over many points

const quantities = Object.fromEntries(known.quantities.map((each) => [each.name, each]));
// The explored place: the value of each axis, in the axis's own unit. Quantities share it.
const state = {};
// By quantity: the axis that its curves are drawn against.
const against = Object.fromEntries(known.quantities.map((each) => [each.name, each.against]));
// The names of the tables that are drawn.
const shown = new Set(known.quantities.flatMap((quantity) =>
    quantity.tables.filter((table) => table.shown).map((table) => table.name)));
let current = known.quantities[0];
// Curves against a polar angle go through the zenith. On this side of it, 1 or −1, is the place.
let side = 1;

// Makes a quantity the explored one, and moves the place into the ranges of its sliders.
function select(name) {
    current = quantities[name];
    side = 1;
    for (const { name: axis, low, high, start } of current.axes)
        state[axis] = Math.min(Math.max(state[axis] ?? start, low), high);
}

function chosenTables() {
    return current.tables.filter((table) => shown.has(table.name));
}

// The weighted sum of a function over the points of a product of rules. `point` is extended by one
// node of each rule.
function weightedSum(value, point, rules) {
    if (!rules.length) return value(...point);
    const [{ nodes, weights }, ...others] = rules;
    return nodes.reduce(
        (sum, node, i) => sum + weights[i] * weightedSum(value, [...point, node], others), 0);
}

function hasExact({ exact, average }) {
    return Boolean(exact || average);
}

// The exact value of the current quantity; NaN if the page cannot compute it.
function exactAt(point) {
    const { exact, average } = current;
    if (exact) return exported[exact](...point);
    return average ? weightedSum(exported[average.integrand], point, average.rules) : NaN;
}

// Names the axes on which a point is outside the domain of a table, or returns "".
function outside(table, point) {
    return table.domain.flatMap(([low, high], i) => {
        const inside = point[i] >= low && point[i] <= high;
        return inside ? [] : [current.axes[i].symbol];
    }).join(", ");
}

// Evaluates a table by its exported functions. The first result of two functions is kept until its
// arguments change, as in a renderer, which computes it once for a material.
function evaluate(table, point) {
    const first = table.order.map((axis) => point[axis]);
    const [name, second] = table.functions;
    if (!second) return exported[name](...first);
    if (!table.cached || first.some((value, i) => value !== table.cached.first[i]))
        table.cached = { first, results: exported[name](...first) };
    return exported[second](table.cached.results, ...exported[table.inputs](...point));
}

// The explored point, with the values of some axes changed.
function at(changes = {}) {
    return current.axes.map((axis) => changes[axis.name] ?? state[axis.name]);
}

function axisOf(name) {
    return current.axes.find((axis) => axis.name === name);
}

// Values of an axis that a curve is drawn at. A polar angle of a hemisphere is drawn through the
// zenith: angles on the other side are directions with the opposite azimuth.
function places(name) {
    const { low, high, logarithmic } = axisOf(name);
    const from = name === current.hemisphere?.polar ? -high : low;
    const count = current.exact || !current.average ? STEPS : AVERAGE_STEPS;
    const place = (fraction) => logarithmic ? from * (high / from) ** fraction
        : from + (high - from) * fraction;
    return Array.from({ length: count + 1 }, (_, i) => i < count ? place(i / count) : high);
}

function isOpposite(name, value) {
    return name === current.hemisphere?.polar && value * side < 0;
}

// The values of axes at a place of a curve, by name.
function changesAlong(name, value) {
    if (name !== current.hemisphere?.polar) return { [name]: value };
    if (!isOpposite(name, value)) return { [name]: Math.abs(value) };
    const { azimuth } = current.hemisphere;
    const turned = state[azimuth] + (state[azimuth] > 0 ? -Math.PI : Math.PI);
    return { [name]: Math.abs(value), [azimuth]: turned };
}

function pointAlong(name, value) {
    return at(changesAlong(name, value));
}

// Where the explored place is on a curve.
function placeAlong(name) {
    return name === current.hemisphere?.polar ? side * state[name] : state[name];
}

// Moves the explored place along a curve.
function moveAlong(name, value) {
    const { low, high } = axisOf(name);
    const opposite = isOpposite(name, value);
    Object.assign(state, changesAlong(name, value));
    if (opposite) side = -side;
    state[name] = Math.min(Math.max(state[name], low), high);
}

// Sets an axis to a text in the shown unit. Returns "", or what is wrong with the text.
function enterText(axis, text) {
    const { name, symbol, low, high, factor, unit } = axis;
    const value = text.trim() === "" ? NaN : Number(text);
    const [least, most] = [low * factor, high * factor].map((end) => Number(end.toPrecision(6)));
    if (!(value >= least && value <= most))
        return `${symbol} must be a number from ${least} to ${most}${unit}`;
    state[name] = Math.min(Math.max(value / factor, low), high);
    return "";
}

// The value of an axis in the shown unit, as text.
function shownText({ name, factor }) {
    return String(Number((state[name] * factor).toPrecision(6)));
}
