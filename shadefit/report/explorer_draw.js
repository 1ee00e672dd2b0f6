// Drawing: line charts in SVG, and discs on a canvas. Nothing here depends on the quantity.

function element(name, attributes = {}, text = "") {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.textContent = text;
    return made;
}

// Draws lines into a container, over its whole width. Each of `lines` is { style, points:
// [[x, y], …] }, with y = NaN where nothing is drawn. `x` and `y` are { range, logarithmic, ticks,
// label }. A vertical line marks x = `mark`, the explored place. Returns the function from a
// horizontal place on the screen to x.
function chart(container, { lines, x, y, mark, height, label }) {
    const width = Math.max(260, container.clientWidth);
    const [left, right, top, bottom] = [62, 12, 10, 36];
    const [wide, high] = [width - left - right, height - top - bottom];
    const [xScale, yScale] = [x, y].map(({ range, logarithmic }) => scaleOf(range, logarithmic));
    const across = (value) => left + wide * xScale.to(value);
    const down = (value) => top + high * (1 - yScale.to(value));

    const svg = element("svg", {
        viewBox: `0 0 ${width} ${height}`,
        width,
        height,
        role: "img",
        "aria-label": label,
    });
    for (const value of y.ticks) {
        svg.append(element("line", { class: value ? "grid" : "zero",
            x1: left, x2: width - right, y1: down(value), y2: down(value) }));
        svg.append(element("text", { class: "tick", x: left - 6, y: down(value) + 4,
            "text-anchor": "end" }, short(value)));
    }
    for (const value of x.ticks) {
        svg.append(element("line", { class: "grid",
            x1: across(value), x2: across(value), y1: top, y2: height - bottom }));
        svg.append(element("text", { class: "tick", x: across(value), y: height - bottom + 15,
            "text-anchor": "middle" }, short(value)));
    }
    svg.append(element("text", { class: "name", x: left + wide / 2, y: height - 4,
        "text-anchor": "middle" }, x.label));
    svg.append(element("text", { class: "name", "text-anchor": "middle",
        transform: `translate(11 ${top + high / 2}) rotate(-90)` }, y.label));
    svg.append(element("line", { class: "mark",
        x1: across(mark), x2: across(mark), y1: top, y2: height - bottom }));
    // What is outside the ranges is cut off.
    const inner = element("svg", { x: left, y: top - 1, width: wide, height: high + 2,
        viewBox: `${left} ${top - 1} ${wide} ${high + 2}` });
    for (const line of lines) {
        let path = "";
        let drawing = false;
        for (const [px, py] of line.points) {
            const seen = Number.isFinite(py);
            const place = () => Math.min(Math.max(down(py), -height), 2 * height).toFixed(2);
            if (seen) path += `${drawing ? "L" : "M"}${across(px).toFixed(2)} ${place()}`;
            drawing = seen;
        }
        inner.append(element("path", { d: path, class: "line", style: line.style }));
    }
    svg.append(inner);
    container.replaceChildren(svg);
    return (clientX) => {
        const fraction = (clientX - svg.getBoundingClientRect().left - left) / wide;
        return xScale.from(Math.min(Math.max(fraction, 0), 1));
    };
}

// Fills the unit disc of a square canvas. `value(x, y, pixel)` is a place on the colour ramp, from 0
// to 1, or NaN for a pixel without colour.
function disc(canvas, ramp, value) {
    const size = canvas.width;
    const context = canvas.getContext("2d");
    const image = context.createImageData(size, size);
    forPixels(size, (x, y, pixel) => {
        const fraction = value(x, y, pixel);
        if (!Number.isFinite(fraction)) return;
        const place = Math.min(Math.max(fraction, 0), 1) * (ramp.length - 1);
        const index = Math.min(Math.floor(place), ramp.length - 2);
        const weight = place - index;
        for (let part = 0; part < 3; ++part) {
            const [low, high] = [ramp[index][part], ramp[index + 1][part]];
            image.data[4 * pixel + part] = low + weight * (high - low);
        }
        image.data[4 * pixel + 3] = 255;
    });
    context.putImageData(image, 0, 0);
}

// Calls a function with the place (x, y) in the unit disc, and the number, of each pixel of a square.
function forPixels(size, call) {
    for (let row = 0; row < size; ++row) {
        for (let column = 0; column < size; ++column) {
            const x = ((column + 0.5) / size) * 2 - 1;
            const y = 1 - ((row + 0.5) / size) * 2;
            // Slightly more than the disc is filled; the style sheet cuts off the rest.
            if (x * x + y * y <= 1.05) call(x, y, row * size + column);
        }
    }
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

// Returns a colour bar, with the values at its ends and in its middle.
function colourBar(ramp, [low, high], label) {
    const bar = document.createElement("div");
    bar.className = "bar";
    bar.setAttribute("role", "img");
    bar.setAttribute("aria-label", `${label}: colours from ${short(low)} to ${short(high)}`);
    const strip = document.createElement("div");
    strip.className = "strip";
    const colours = ramp.map((colour) => `rgb(${colour.join(" ")})`);
    strip.style.background = `linear-gradient(to right, ${colours.join(", ")})`;
    const ends = document.createElement("div");
    ends.className = "ends";
    ends.append(...[low, (low + high) / 2, high].map((value) => {
        const end = document.createElement("span");
        end.textContent = short(value);
        return end;
    }));
    bar.append(strip, ends);
    return bar;
}
