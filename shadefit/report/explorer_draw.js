// Drawing: line charts in SVG, and discs on a canvas. Nothing here depends on the quantity.

function element(name, attributes = {}, text = "") {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.textContent = text;
    return made;
}

// Round steps of 1, 2 or 5 times a power of ten, about `count` of them from low to high.
function ticks(low, high, count) {
    const rough = (high - low) / count;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
    const first = Math.ceil(low / step - 1e-9);
    const last = Math.floor(high / step + 1e-9);
    return Array.from({ length: last - first + 1 }, (_, i) => (first + i) * step);
}

function short(value) {
    const rounded = Math.abs(value) < 1e-12 ? 0 : Number(value.toPrecision(3));
    const small = rounded !== 0 && Math.abs(rounded) < 1e-3;
    return (small ? rounded.toExponential() : String(rounded)).replaceAll("-", "−");
}

// Draws lines into a container, over its whole width. Each of `lines` is { style, points:
// [[x, y], …] }, with y = NaN where nothing is drawn. The range of y contains the values `bounds`.
// A vertical line marks x = `mark`, the explored place.
function chart(container, { lines, bounds, xRange, xTicks, xLabel, yLabel, mark, height, label }) {
    const width = Math.max(260, container.clientWidth);
    const [left, right, top, bottom] = [62, 12, 12, 38];
    const finite = lines.flatMap((line) => line.points.map(([, y]) => y)).filter(Number.isFinite);
    let [low, high] = [Math.min(...finite, ...bounds), Math.max(...finite, ...bounds)];
    if (low > high) [low, high] = [0, 1];
    if (high === low) [low, high] = [low - 1e-6, high + 1e-6];
    const [from, to] = xRange;
    const x = (value) => left + ((value - from) / (to - from)) * (width - left - right);
    const y = (value) => top + ((high - value) / (high - low)) * (height - top - bottom);

    const svg = element("svg", {
        viewBox: `0 0 ${width} ${height}`,
        width,
        height,
        role: "img",
        "aria-label": label,
    });
    for (const value of ticks(low, high, height > 200 ? 6 : 5)) {
        svg.append(element("line", { class: value ? "grid" : "zero",
            x1: left, x2: width - right, y1: y(value), y2: y(value) }));
        svg.append(element("text", { class: "tick", x: left - 6, y: y(value) + 4,
            "text-anchor": "end" }, short(value)));
    }
    for (const value of xTicks) {
        svg.append(element("line", { class: "grid",
            x1: x(value), x2: x(value), y1: top, y2: height - bottom }));
        svg.append(element("text", { class: "tick", x: x(value), y: height - bottom + 15,
            "text-anchor": "middle" }, short(value)));
    }
    svg.append(element("text", { class: "name", x: (left + width - right) / 2, y: height - 5,
        "text-anchor": "middle" }, xLabel));
    svg.append(element("text", { class: "name", "text-anchor": "middle",
        transform: `translate(11 ${(top + height - bottom) / 2}) rotate(-90)` }, yLabel));
    svg.append(element("line", { class: "mark",
        x1: x(mark), x2: x(mark), y1: top, y2: height - bottom }));
    for (const line of lines) {
        let path = "";
        let drawing = false;
        for (const [px, py] of line.points) {
            const seen = Number.isFinite(py);
            if (seen) path += `${drawing ? "L" : "M"}${x(px).toFixed(2)} ${y(py).toFixed(2)}`;
            drawing = seen;
        }
        svg.append(element("path", { d: path, class: "line", style: line.style }));
    }
    container.replaceChildren(svg);
}

// Fills the unit disc of a square canvas. `value(x, y, pixel)` is a place on the colour ramp, from 0
// to 1, or NaN for a pixel without colour.
function disc(canvas, ramp, value) {
    const size = canvas.width;
    const context = canvas.getContext("2d");
    const image = context.createImageData(size, size);
    for (let row = 0; row < size; ++row) {
        for (let column = 0; column < size; ++column) {
            const x = ((column + 0.5) / size) * 2 - 1;
            const y = 1 - ((row + 0.5) / size) * 2;
            // Slightly more than the disc is filled; the style sheet cuts off the rest.
            if (x * x + y * y > 1.05) continue;
            const pixel = row * size + column;
            const fraction = value(x, y, pixel);
            if (!Number.isFinite(fraction)) continue;
            const place = Math.min(Math.max(fraction, 0), 1) * (ramp.length - 1);
            const index = Math.min(Math.floor(place), ramp.length - 2);
            const weight = place - index;
            for (let part = 0; part < 3; ++part) {
                const [low, high] = [ramp[index][part], ramp[index + 1][part]];
                image.data[4 * pixel + part] = low + weight * (high - low);
            }
            image.data[4 * pixel + 3] = 255;
        }
    }
    context.putImageData(image, 0, 0);
}

// Draws a ring around a place of the unit disc.
function ring(canvas, x, y) {
    const context = canvas.getContext("2d");
    const half = canvas.width / 2;
    context.beginPath();
    context.arc(half * (1 + x), half * (1 - y), 4, 0, 2 * Math.PI);
    for (const [width, colour] of [[2.5, "#ffffff"], [1.2, "#000000"]]) {
        context.lineWidth = width;
        context.strokeStyle = colour;
        context.stroke();
    }
}
