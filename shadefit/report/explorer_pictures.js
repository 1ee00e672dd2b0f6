// The pictures of the current quantity: curves of values and errors, and discs of a hemisphere.

const BEST = ["--best-0", "--best-1", "--best-2", "--best-3"];
const DASHES = {
    exact: "none", published: "7 4", printed: "7 3 2 3", refitted: "2.5 3",
};
// There may be many best tables: every colour is combined with every dash.
const BEST_DASHES = ["11 3 3 3", "9 3 2 3 2 3", "14 4", "4 4 1 4"];

// The names of the tables that are drawn.
const shown = new Set(known.quantities.flatMap((quantity) =>
    quantity.tables.filter((table) => table.shown).map((table) => table.name)));

const find = (id) => document.getElementById(id);

function chosenTables() {
    return current.tables.filter((table) => shown.has(table.name));
}

function styleOf({ kind, name }) {
    if (kind !== "best") return `stroke: var(--${kind}); stroke-dasharray: ${DASHES[kind]}`;
    const index = current.tables.filter((each) => each.kind === "best")
        .findIndex((each) => each.name === name);
    const dash = BEST_DASHES[Math.floor(index / BEST.length) % BEST_DASHES.length];
    return `stroke: var(${BEST[index % BEST.length]}); stroke-dasharray: ${dash}`;
}

function drawCharts() {
    const axis = axisOf(against[current.name]);
    const { name, symbol, factor, unit } = axis;
    const angle = unit === "°";
    const values = places(name);
    const points = values.map((value) => pointAlong(name, value));
    const chosen = chosenTables();
    const fitted = chosen.map((table) => points.map((point) => evaluate(table, point)));
    const line = (style, ys) => ({ style, points: values.map((x, i) => [x * factor, ys[i]]) });
    const xRange = [values[0] * factor, values.at(-1) * factor];
    const xTicks = !angle ? ticks(...xRange, 5)
        : [0, 1, 2, 3, 4, 5, 6].map((i) => xRange[0] + ((xRange[1] - xRange[0]) * i) / 6);
    const few = find("values-chart").clientWidth < 480;
    const common = {
        xRange,
        xTicks: xTicks.filter((_, i) => !angle || !few || i % 2 === 0),
        xLabel: symbol + (unit ? ` / ${unit}` : ""),
        mark: state[name] * factor,
    };
    const range = `against ${symbol} from ${short(xRange[0])} to ${short(xRange[1])}`;
    const truth = points.map(exactAt);
    const lines = chosen.map((table, i) => line(styleOf(table), fitted[i]));
    if (hasExact(current)) lines.unshift(line(styleOf({ kind: "exact" }), truth));
    const extremes = [Math.min(...truth), Math.max(...truth)].map((value) => value.toFixed(3));
    const said = hasExact(current) ? `exact values from ${extremes.join(" to ")}`
        : chosen.map((table) => table.name).join("; ") || "no table is chosen";
    chart(find("values-chart"), {
        ...common, lines, bounds: current.values, height: 280, yLabel: current.symbol,
        label: `${current.symbol} ${range}: ${said}`,
    });
    find("errors-chart").hidden = !hasExact(current);
    if (!hasExact(current)) return;
    const errors = fitted.map((ys) => ys.map((value, i) => value - truth[i]));
    const worst = chosen.map((table, i) => {
        const largest = Math.max(0, ...errors[i].filter(Number.isFinite).map(Math.abs));
        return `${table.name} up to ${largest.toExponential(1)}`;
    });
    chart(find("errors-chart"), {
        ...common, lines: chosen.map((table, i) => line(styleOf(table), errors[i])),
        bounds: [0], height: 190, yLabel: "table − exact",
        label: `Errors ${range}: ${worst.join("; ") || "no table is chosen"}`,
    });
}

// One disc of exact values, and one of errors for each chosen table.
function drawDiscs() {
    const { hemisphere, largestError } = current;
    find("above").hidden = !(hemisphere && hasExact(current));
    if (find("above").hidden) return;
    find("above-caption").textContent = hemisphere.caption;
    const chosen = chosenTables();
    const canvases = discCanvases(chosen);
    const point = (x, y) => at({
        [hemisphere.polar]: Math.asin(Math.min(Math.sqrt(x * x + y * y), 1)),
        [hemisphere.azimuth]: Math.atan2(y, x),
    });
    const truth = [];
    disc(canvases[0], known.colours.values, (x, y, pixel) => {
        truth[pixel] = exactAt(point(x, y));
        return truth[pixel];
    });
    chosen.forEach((table, i) => {
        disc(canvases[i + 1], known.colours.errors, (x, y, pixel) =>
            0.5 + (evaluate(table, point(x, y)) - truth[pixel]) / (2 * largestError));
    });
    const distance = Math.sin(state[hemisphere.polar]);
    const azimuth = state[hemisphere.azimuth];
    for (const canvas of canvases)
        ring(canvas, distance * Math.cos(azimuth), distance * Math.sin(azimuth));
}

// Returns the canvases, which are made anew when the chosen tables change.
function discCanvases(chosen) {
    const holder = find("discs");
    const names = ["exact", ...chosen.map((table) => table.name)];
    if (holder.dataset.shown !== names.join()) {
        holder.dataset.shown = names.join();
        holder.replaceChildren(...names.map((name) => {
            const figure = document.createElement("figure");
            const canvas = document.createElement("canvas");
            canvas.width = canvas.height = 120;
            canvas.setAttribute("role", "img");
            const caption = document.createElement("figcaption");
            caption.textContent = name === "exact" ? "exact, 0 to 1"
                : `${name} − exact, ±${current.largestError}`;
            canvas.setAttribute("aria-label", `${current.symbol} over the hemisphere: ${name}`);
            figure.append(canvas, caption);
            return figure;
        }));
    }
    return holder.querySelectorAll("canvas");
}
