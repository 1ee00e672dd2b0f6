// The pictures of the current quantity: curves of values and errors, and discs of a hemisphere.

const KIND_DASHES = {
    exact: "none", published: "7 4", printed: "7 3 2 3", refitted: "2.5 3",
};
// The other tables have colours of their own. The style sheet has this many; further ones are spread
// by the golden angle, so that none is repeated.
const COLOURS = 10;
const GOLDEN_ANGLE = 137.508;
const DASHES = ["11 3 3 3", "9 3 2 3 2 3", "14 4", "4 4 1 4"];

const find = (id) => document.getElementById(id);

function styleOf({ kind, name }) {
    if (kind in KIND_DASHES) return `stroke: var(--${kind}); stroke-dasharray: ${KIND_DASHES[kind]}`;
    const index = current.tables.filter((each) => !(each.kind in KIND_DASHES))
        .findIndex((each) => each.name === name);
    const colour = index < COLOURS ? `var(--best-${index})`
        : `hsl(${((index * GOLDEN_ANGLE) % 360).toFixed(1)} 60% 50%)`;
    return `stroke: ${colour}; stroke-dasharray: ${DASHES[index % DASHES.length]}`;
}

function horizontal(axis, values) {
    const { symbol, factor, unit, logarithmic } = axis;
    const range = [values[0] * factor, values.at(-1) * factor];
    const few = find("values-chart").clientWidth < 480;
    const sixths = [0, 1, 2, 3, 4, 5, 6].filter((i) => !few || i % 2 === 0);
    const round = unit === "°" ? sixths.map((i) => range[0] + ((range[1] - range[0]) * i) / 6)
        : logarithmic ? powersOfTen(...range, 6) : ticks(...range, 5);
    return { range, logarithmic, ticks: round, label: symbol + (unit ? ` / ${unit}` : "") };
}

function drawCharts() {
    const axis = axisOf(against[current.name]);
    const { name, symbol, factor } = axis;
    const values = places(name);
    const points = values.map((value) => pointAlong(name, value));
    const chosen = chosenTables();
    const fitted = chosen.map((table) => points.map((point) => evaluate(table, point)));
    const truth = points.map(exactAt);
    const line = (style, ys) => ({ style, points: values.map((x, i) => [x * factor, ys[i]]) });
    const x = horizontal(axis, values);
    const common = { x, mark: placeAlong(name) * factor };
    const small = window.matchMedia("(max-width: 60rem)").matches;
    const range = `against ${symbol} from ${short(x.range[0])} to ${short(x.range[1])}`;

    const lines = chosen.map((table, i) => line(styleOf(table), fitted[i]));
    if (hasExact(current)) lines.unshift(line(styleOf({ kind: "exact" }), truth));
    const extremes = [Math.min(...truth), Math.max(...truth)].map((value) => value.toFixed(3));
    const said = hasExact(current) ? `exact values from ${extremes.join(" to ")}`
        : chosen.map((table) => table.name).join("; ") || "no table is chosen";
    const shownRange = rangeOfCurves(truth, fitted);
    const toPlace = chart(find("values-chart"), {
        ...common, lines, height: small ? 150 : 280,
        y: { range: shownRange, ticks: ticks(...shownRange, 5), label: current.symbol },
        label: `${current.symbol} ${range}: ${said}`,
    });
    find("values-chart").toPlace = (clientX) => toPlace(clientX) / factor;
    find("errors-chart").toPlace = find("values-chart").toPlace;
    find("errors-chart").hidden = find("scales").hidden = !hasExact(current);
    find("no-exact").hidden = hasExact(current);
    if (hasExact(current)) drawErrors(chosen, fitted, truth, { ...common, line, range, small });
}

function drawErrors(chosen, fitted, truth, { x, mark, line, range, small }) {
    const errors = fitted.map((ys) => ys.map((value, i) => value - truth[i]));
    const scale = rangeOfErrors(errors, choices.errors);
    const { logarithmic } = scale;
    const drawn = errors.map((ys) => logarithmic ? ys.map(Math.abs) : ys);
    const worst = chosen.map((table, i) =>
        `${table.name} up to ${largest(errors[i]).toExponential(1)}`);
    chart(find("errors-chart"), {
        x, mark, lines: chosen.map((table, i) => line(styleOf(table), drawn[i])),
        height: small ? 125 : 200,
        y: {
            ...scale,
            ticks: logarithmic ? powersOfTen(...scale.range, 4) : ticks(...scale.range, 4),
            label: logarithmic ? "|table − exact|" : "table − exact",
        },
        label: `Errors ${range}: ${worst.join("; ") || "no table is chosen"}`,
    });
}

// The direction at a place of the unit disc, as values of axes by name.
function directionAt(x, y) {
    const { polar, azimuth } = current.hemisphere;
    return {
        [polar]: Math.asin(Math.min(Math.hypot(x, y), 1)),
        [azimuth]: Math.atan2(y, x),
    };
}

// One disc of exact values, and one of errors for each chosen table, with their colour bars.
function drawDiscs() {
    const { hemisphere } = current;
    find("above").hidden = find("for-maps").hidden = !(hemisphere && hasExact(current));
    if (find("above").hidden) return;
    find("above-caption").textContent = hemisphere.caption;
    const chosen = chosenTables();
    const figures = discFigures(chosen);
    const canvases = figures.map((figure) => figure.querySelector("canvas"));
    const truth = [];
    const errors = chosen.map(() => []);
    forPixels(canvases[0].width, (x, y, pixel) => {
        const point = at(directionAt(x, y));
        truth[pixel] = exactAt(point);
        chosen.forEach((table, i) => {
            errors[i][pixel] = evaluate(table, point) - truth[pixel];
        });
    });
    const [low, high] = roundRange(truth, 4);
    disc(canvases[0], known.colours.values, (x, y, pixel) => (truth[pixel] - low) / (high - low));
    describe(figures[0], "exact", known.colours.values, [low, high]);
    const worst = errors.map(largest);
    const limits = limitsOfMaps(worst, choices.maps);
    chosen.forEach((table, i) => {
        const limit = limits[i];
        disc(canvases[i + 1], known.colours.errors, (x, y, pixel) =>
            0.5 + errors[i][pixel] / (2 * limit));
        const title = `${table.name} − exact, up to ${worst[i].toExponential(1)}`;
        describe(figures[i + 1], title, known.colours.errors, [-limit, limit]);
    });
    const distance = Math.sin(state[hemisphere.polar]);
    const azimuth = state[hemisphere.azimuth];
    for (const canvas of canvases)
        ring(canvas, distance * Math.cos(azimuth), distance * Math.sin(azimuth));
}

function describe(figure, title, ramp, range) {
    figure.querySelector("figcaption").textContent = title;
    figure.querySelector(".bar").replaceWith(colourBar(ramp, range, title));
}

// Returns the figures, which are made anew when the chosen tables change.
function discFigures(chosen) {
    const holder = find("discs");
    const names = ["exact", ...chosen.map((table) => table.name)];
    const key = JSON.stringify([current.name, names]);
    if (holder.dataset.shown !== key) {
        holder.dataset.shown = key;
        holder.replaceChildren(...names.map((name) => {
            const figure = document.createElement("figure");
            const canvas = document.createElement("canvas");
            canvas.width = canvas.height = 120;
            canvas.setAttribute("role", "img");
            canvas.setAttribute("aria-label", `${current.symbol} over the hemisphere: ${name}`);
            const bar = document.createElement("div");
            bar.className = "bar";
            figure.append(canvas, bar, document.createElement("figcaption"));
            return figure;
        }));
    }
    return [...holder.children];
}
