// Drawing: line charts in SVG, discs on a canvas. Nothing here knows what is drawn.

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
    const text = Math.abs(value) < 1e-12 ? "0" : String(Number(value.toPrecision(3)));
    return text.replace("-", "−");
}

// Draws `lines` ({ style, points: [[x, y], …] }, y NaN where there is nothing) into a container as
// wide as it is; `bounds`, values of y that are
// seen whatever the lines need; `mark` is x of the place explored.
function chart(container, { lines, bounds, xRange, xTicks, xLabel, yLabel, mark, height, label }) {
    const width = Math.max(260, container.clientWidth);
    const [left, right, top, bottom] = [54, 12, 12, 38];
    const finite = lines.flatMap((line) => line.points.map(([, y]) => y)).filter(Number.isFinite);
    let [low, high] = [Math.min(...finite, ...bounds), Math.max(...finite, ...bounds)];
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

// Fills the unit disc of a square canvas: `value(x, y, pixel)` in [0, 1], NaN for nothing.
function disc(canvas, ramp, value) {
    const size = canvas.width;
    const context = canvas.getContext("2d");
    const image = context.createImageData(size, size);
    for (let row = 0; row < size; ++row) {
        for (let column = 0; column < size; ++column) {
            const x = ((column + 0.5) / size) * 2 - 1;
            const y = 1 - ((row + 0.5) / size) * 2;
            // A little more than the disc: the style sheet cuts it round.
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
