// The model of the explorer: the state of the controls, and values by the printed functions.
// It does not need a page: tests run it in Node.

const STEPS = 160; // of a curve
const AVERAGE_STEPS = 60; // of a curve of averages, each of which is a sum over many points

const quantities = Object.fromEntries(known.quantities.map((each) => [each.name, each]));
// The explored place: the value of each axis, in the axis's own unit. Quantities share it.
const state = {};
// By quantity: the axis that its curves are drawn against.
const against = Object.fromEntries(known.quantities.map((each) => [each.name, each.against]));
let current = known.quantities[0];

// Makes a quantity the explored one, and moves the place into the ranges of its sliders.
function select(name) {
    current = quantities[name];
    for (const { name: axis, low, high, start } of current.axes)
        state[axis] = Math.min(Math.max(state[axis] ?? start, low), high);
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
// zenith: negative angles are directions with the opposite azimuth.
function places(name) {
    const { low, high } = axisOf(name);
    const from = name === current.hemisphere?.polar ? -high : low;
    const count = current.exact || !current.average ? STEPS : AVERAGE_STEPS;
    return Array.from({ length: count + 1 }, (_, i) => from + ((high - from) * i) / count);
}

function pointAlong(name, value) {
    const { polar, azimuth } = current.hemisphere ?? {};
    if (name !== polar || value >= 0) return at({ [name]: value });
    const turned = state[azimuth] + (state[azimuth] > 0 ? -Math.PI : Math.PI);
    return at({ [polar]: -value, [azimuth]: turned });
}
