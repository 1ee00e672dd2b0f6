// Scales: round numbers, and ranges that adapt to values. Tests run this in Node.

// The quotient of largest errors from which they are drawn on a logarithmic scale.
const FAR_APART = 20;
// A logarithmic scale begins at this fraction of the smallest of the largest errors.
const BELOW = 1e-2;

// The smallest of 1, 2 and 5 times a power of ten that is not below a positive value.
function roundUp(value) {
    const power = 10 ** Math.floor(Math.log10(value));
    return power * [1, 2, 5, 10].find((factor) => factor * power >= value * (1 - 1e-9));
}

// Round steps of 1, 2 or 5 times a power of ten, about `count` of them from low to high.
function ticks(low, high, count) {
    const step = roundUp((high - low) / count);
    const first = Math.ceil(low / step - 1e-9);
    const last = Math.floor(high / step + 1e-9);
    return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
}

// Powers of ten from low to high, every one or as many as fit. If there is at most one, round steps.
function powersOfTen(low, high, count) {
    const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
    if (last - first < 1) return ticks(low, high, count);
    const step = Math.ceil((last - first) / count);
    const size = Math.floor((last - first) / step) + 1;
    return Array.from({ length: size }, (_, i) => 10 ** (first + i * step));
}

// The range of values, extended to round steps. A range without width gets one.
function roundRange(values, count = 5) {
    const finite = values.filter(Number.isFinite);
    if (!finite.length) return [0, 1];
    let [low, high] = [Math.min(...finite), Math.max(...finite)];
    const least = Math.max(1e-9, 1e-6 * Math.max(Math.abs(low), Math.abs(high)));
    if (high - low < least) [low, high] = [low - least / 2, high + least / 2];
    const step = roundUp((high - low) / count);
    return [Math.floor(low / step + 1e-9) * step, Math.ceil(high / step - 1e-9) * step];
}

// The range in which curves are drawn: that of the exact values, and of tables near to them. A table
// may be far away outside its domain; its curve then leaves the picture.
function rangeOfCurves(truth, fitted) {
    const finite = truth.filter(Number.isFinite);
    const every = fitted.flat().filter(Number.isFinite);
    if (!finite.length) return roundRange(every);
    const [low, high] = [Math.min(...finite), Math.max(...finite)];
    const margin = Math.max(high - low, 0.1 * Math.max(Math.abs(low), Math.abs(high)));
    return roundRange([low, high, ...every.map((value) =>
        Math.min(Math.max(value, low - margin), high + margin))]);
}

function largest(values) {
    return values.reduce((most, value) =>
        Number.isFinite(value) ? Math.max(most, Math.abs(value)) : most, 0);
}

// The range of errors, each a list of one table, and whether it is logarithmic. `wanted` is
// "automatic", "linear" or "logarithmic". A logarithmic scale is one of absolute errors.
function rangeOfErrors(errors, wanted) {
    const worst = errors.map(largest).filter((value) => value > 0);
    if (!worst.length) return { logarithmic: false, range: [-1e-6, 1e-6] };
    const [least, most] = [Math.min(...worst), Math.max(...worst)];
    const logarithmic = wanted === "logarithmic"
        || (wanted === "automatic" && most > FAR_APART * least);
    if (!logarithmic) return { logarithmic, range: roundRange([0, ...errors.flat()], 4) };
    const power = (value) => Math.log10(value);
    return { logarithmic,
        range: [10 ** Math.floor(power(BELOW * least)), 10 ** Math.ceil(power(most) - 1e-9)] };
}

// The limits of the colour scales of tables' maps, from the largest error of each. `wanted` is "own"
// for one scale for each table, "common" for one for all, or "automatic": one for all unless the
// errors differ so much that some maps would have no colour.
function limitsOfMaps(worst, wanted) {
    const positive = worst.filter((value) => value > 0);
    const most = Math.max(...worst);
    const own = wanted === "own"
        || (wanted === "automatic" && most > FAR_APART * Math.min(...positive));
    return worst.map((value) => roundUp(Math.max(own ? value : most, 1e-15)));
}

// A map from values to the interval from 0 to 1, and back.
function scaleOf([low, high], logarithmic) {
    if (!logarithmic) return {
        to: (value) => (value - low) / (high - low),
        from: (fraction) => low + fraction * (high - low),
    };
    const width = Math.log(high / low);
    return {
        to: (value) => Math.log(Math.max(value, Number.MIN_VALUE) / low) / width,
        from: (fraction) => low * Math.exp(fraction * width),
    };
}

function short(value) {
    const rounded = Math.abs(value) < 1e-12 ? 0 : Number(value.toPrecision(3));
    const small = rounded !== 0 && Math.abs(rounded) < 1e-3;
    return (small ? rounded.toExponential() : String(rounded)).replaceAll("-", "−");
}
