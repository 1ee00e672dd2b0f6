// What is explored: the state of the controls, and values by the exported functions.

const STEPS = 160; // of a curve; R, which is an integral itself, has fewer
const INTEGRAL_STEPS = 60;

const quantities = Object.fromEntries(known.quantities.map((each) => [each.name, each]));
const state = Object.fromEntries(
    Object.entries(known.sliders).map(([name, slider]) => [name, slider.start]));
// By quantity: the argument that its curves are drawn against.
const against = { ps: "theta_u", g: "cos_v", q: "density", r: "theta_f" };
let current = quantities.ps;

// R: the exported P_s averaged by Gauss's rule in cos θu and midpoints in φ.
function averageOverLights(alpha, thetaF) {
    const { cosines, weights } = known.rule;
    const count = cosines.length;
    let sum = 0;
    for (let i = 0; i < count; ++i) {
        const thetaU = Math.acos(cosines[i]);
        let row = 0;
        for (let j = 0; j < count; ++j)
            row += exported.exactPs(alpha, thetaF, thetaU, ((j + 0.5) * Math.PI) / count);
        sum += weights[i] * cosines[i] * row;
    }
    return (2 * sum) / count;
}

const exact = {
    ps: exported.exactPs, g: exported.exactG, q: exported.exactQ, r: averageOverLights,
};

// Why a table says nothing at a place, or "".
function outside(table, point) {
    return table.domain.flatMap(([low, high], i) => {
        const inside = point[i] >= low && point[i] <= high;
        return inside ? [] : [current.axes[i].symbol];
    }).join(", ");
}

function evaluate(table, point) {
    return outside(table, point) ? NaN : exported[table.function](...point);
}

function at(changes = {}) {
    return current.axes.map((axis) => changes[axis.name] ?? state[axis.name]);
}

// θu is drawn through the zenith: to the left of it the light stands at φ + 180°.
function places(name) {
    const { low, high } = known.sliders[name];
    const from = name === "theta_u" ? -high : low;
    const count = current.name === "r" ? INTEGRAL_STEPS : STEPS;
    return Array.from({ length: count + 1 }, (_, i) => from + ((high - from) * i) / count);
}

function pointAlong(name, value) {
    if (name !== "theta_u" || value >= 0) return at({ [name]: value });
    const phi = state.phi > 0 ? state.phi - Math.PI : state.phi + Math.PI;
    return at({ theta_u: -value, phi });
}
