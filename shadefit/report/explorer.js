// The page: controls, numbers, curves and discs.

const WAIT = 500; // milliseconds without a change before the values are read out
const DISC_ERROR = 0.1; // where the colours of the errors end
const DASHES = {
    exact: "none", published: "7 4", printed: "7 3 2 3", refitted: "2.5 3",
};
// Of other forms there may be many: every colour with every dash.
const BEST = ["--best-0", "--best-1", "--best-2", "--best-3"];
const BEST_DASHES = ["11 3 3 3", "9 3 2 3 2 3", "14 4", "4 4 1 4"];

// The tables that are drawn.
const shown = new Set(known.quantities.flatMap((quantity) =>
    quantity.tables.filter((table) => table.shown).map((table) => table.name)));

const find = (id) => document.getElementById(id);
const degrees = (angle) => (angle * 180) / Math.PI;

function styleOf(table) {
    const { kind, name } = table;
    if (kind !== "best") return `stroke: var(--${kind}); stroke-dasharray: ${DASHES[kind]}`;
    const index = current.tables.filter((each) => each.kind === "best")
        .findIndex((each) => each.name === name);
    const dash = BEST_DASHES[Math.floor(index / BEST.length) % BEST_DASHES.length];
    return `stroke: var(${BEST[index % BEST.length]}); stroke-dasharray: ${dash}`;
}

// A column to choose what is drawn, a swatch of its line, its value, and how far off it is.
function fillTable() {
    const rows = [{ name: "exact", kind: "exact" }, ...current.tables].map((table) => {
        const row = document.createElement("tr");
        row.dataset.table = table.name;
        const head = document.createElement("th");
        head.scope = "row";
        const swatch = element("svg", { class: "swatch", width: 30, height: 8,
            "aria-hidden": "true" });
        swatch.append(element("line", { x1: 0, x2: 30, y1: 4, y2: 4, class: "line",
            style: styleOf(table) }));
        const label = document.createElement("label");
        if (table.kind !== "exact") {
            const box = document.createElement("input");
            box.type = "checkbox";
            box.checked = shown.has(table.name);
            box.addEventListener("change", () => {
                shown[box.checked ? "add" : "delete"](table.name);
                draw();
            });
            label.append(box);
        }
        label.append(swatch, ` ${table.name}`);
        head.append(label);
        row.append(head, document.createElement("td"), document.createElement("td"));
        return row;
    });
    find("values").replaceChildren(...rows);
}

function updateValues() {
    const point = at();
    const truth = exact[current.name](...point);
    const said = [`${current.symbol} exact ${truth.toFixed(4)}`];
    for (const row of find("values").rows) {
        const table = current.tables.find((each) => each.name === row.dataset.table);
        const value = table ? evaluate(table, point) : truth;
        const [, number, error] = row.cells;
        error.className = Number.isFinite(value) ? "number" : "faint";
        number.textContent = Number.isFinite(value) ? value.toFixed(8) : "—";
        if (!table) continue;
        error.textContent = Number.isFinite(value)
            ? `${value < truth ? "−" : "+"}${Math.abs(value - truth).toExponential(2)}`
            : `${outside(table, point)} outside its domain`;
        if (shown.has(table.name) && Number.isFinite(value))
            said.push(`${table.name} ${value.toFixed(4)}`);
    }
    clearTimeout(updateValues.timer);
    updateValues.timer = setTimeout(() => { find("status").textContent = said.join("; "); }, WAIT);
}

function drawCharts() {
    const name = against[current.name];
    const { symbol, unit } = current.axes.find((axis) => axis.name === name);
    const angle = unit === "rad";
    const show = angle ? degrees : (value) => value;
    const values = places(name);
    const points = values.map((value) => pointAlong(name, value));
    const truth = points.map((point) => exact[current.name](...point));
    const chosen = current.tables.filter((table) => shown.has(table.name));
    const fitted = chosen.map((table) => points.map((point) => evaluate(table, point)));
    const line = (style, ys) => ({ style, points: values.map((x, i) => [show(x), ys[i]]) });
    const xRange = [show(values[0]), show(values.at(-1))];
    const xTicks = !angle ? ticks(...xRange, 5)
        : [0, 1, 2, 3, 4, 5, 6].map((i) => xRange[0] + ((xRange[1] - xRange[0]) * i) / 6);
    const few = find("values-chart").clientWidth < 480;
    const common = {
        xRange,
        xTicks: xTicks.filter((_, i) => !angle || !few || i % 2 === 0),
        xLabel: symbol + (angle ? " / °" : ""),
        mark: show(state[name]),
    };
    const range = `against ${symbol} from ${short(xRange[0])} to ${short(xRange[1])}`;
    const lines = [line(styleOf({ kind: "exact" }), truth),
        ...chosen.map((table, i) => line(styleOf(table), fitted[i]))];
    const extremes = [Math.min(...truth), Math.max(...truth)].map((value) => value.toFixed(3));
    chart(find("values-chart"), {
        ...common, lines, bounds: [0, 1], height: 280, yLabel: current.symbol,
        label: `${current.symbol} ${range}: exact values from ${extremes.join(" to ")}`,
    });
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

function drawDiscs() {
    const holder = find("discs");
    find("above").hidden = current.name !== "ps";
    if (current.name !== "ps") return;
    const chosen = current.tables.filter((table) => shown.has(table.name));
    const wanted = [null, ...chosen].map((table) => table?.name ?? "exact");
    if (holder.dataset.shown !== wanted.join()) {
        holder.dataset.shown = wanted.join();
        holder.replaceChildren(...wanted.map((name) => {
            const figure = document.createElement("figure");
            const canvas = document.createElement("canvas");
            canvas.width = canvas.height = 120;
            canvas.setAttribute("role", "img");
            const caption = document.createElement("figcaption");
            caption.textContent = name === "exact" ? "exact, 0 to 1"
                : `${name} − exact, ±${DISC_ERROR}`;
            canvas.setAttribute("aria-label", `P_s over the hemisphere of lights: ${name}`);
            figure.append(canvas, caption);
            return figure;
        }));
    }
    const point = (x, y) => [state.alpha, state.theta_f,
        Math.asin(Math.min(Math.sqrt(x * x + y * y), 1)), Math.atan2(y, x)];
    const canvases = holder.querySelectorAll("canvas");
    const truth = [];
    disc(canvases[0], known.colours.values, (x, y, pixel) => {
        truth[pixel] = exported.exactPs(...point(x, y));
        return truth[pixel];
    });
    chosen.forEach((table, i) => {
        const empty = outside(table, at({ theta_u: 0, phi: 0 }));
        disc(canvases[i + 1], known.colours.errors, (x, y, pixel) => {
            if (empty) return NaN;
            const value = exported[table.function](...point(x, y));
            return 0.5 + (value - truth[pixel]) / (2 * DISC_ERROR);
        });
    });
    const light = [Math.sin(state.theta_u), state.phi];
    for (const canvas of canvases) {
        const context = canvas.getContext("2d");
        const half = canvas.width / 2;
        context.beginPath();
        context.arc(half * (1 + light[0] * Math.cos(light[1])),
            half * (1 - light[0] * Math.sin(light[1])), 4, 0, 2 * Math.PI);
        context.lineWidth = 2.5;
        context.strokeStyle = "#ffffff";
        context.stroke();
        context.lineWidth = 1.2;
        context.strokeStyle = "#000000";
        context.stroke();
    }
}

// A control for an argument: a slider and a number field, both in degrees for an angle.
function control(axis) {
    const slider = known.sliders[axis.name];
    const unit = axis.unit === "rad" ? Math.PI / 180 : 1;
    const group = document.createElement("div");
    group.className = "control";
    const label = document.createElement("label");
    label.htmlFor = `slide-${axis.name}`;
    label.textContent = `${axis.symbol}, ${axis.meaning}`;
    const [range, number] = ["range", "number"].map((type) => {
        const input = document.createElement("input");
        input.type = type;
        input.min = slider.low / unit;
        input.max = slider.high / unit;
        input.step = "any";
        return input;
    });
    range.id = `slide-${axis.name}`;
    range.step = unit === 1 ? 0.001 : 0.5;
    number.id = `enter-${axis.name}`;
    number.setAttribute("aria-label", `${axis.symbol} as a number`);
    const set = (text, source) => {
        const entered = Number.parseFloat(text);
        const fits = entered >= Number(number.min) - 1e-9 && entered <= Number(number.max) + 1e-9;
        number.setAttribute("aria-invalid", String(!fits));
        if (!fits) return;
        state[axis.name] = Math.min(Math.max(entered * unit, slider.low), slider.high);
        if (source !== range) range.value = entered;
        if (source !== number) number.value = String(Number(entered.toPrecision(6)));
        range.setAttribute("aria-valuetext", `${number.value}${unit === 1 ? "" : "°"}`);
        draw();
    };
    range.addEventListener("input", () => set(range.value, range));
    number.addEventListener("input", () => set(number.value, number));
    group.append(label, range, number, unit === 1 ? "" : "°");
    set(String(state[axis.name] / unit), null);
    return group;
}

function choose(name) {
    current = quantities[name];
    find("controls").replaceChildren(...current.axes.map(control));
    const choice = find("against");
    choice.replaceChildren(...current.axes.map((axis) => {
        const selected = axis.name === against[name];
        return new Option(`${axis.symbol}, ${axis.meaning}`, axis.name, selected, selected);
    }));
    fillTable();
    draw();
}

// Once a frame, however fast a slider moves.
function draw() {
    updateValues();
    cancelAnimationFrame(draw.frame);
    draw.frame = requestAnimationFrame(() => {
        drawCharts();
        drawDiscs();
    });
}

for (const input of document.querySelectorAll('input[name="quantity"]'))
    input.addEventListener("change", () => choose(input.value));
find("against").addEventListener("change", (event) => {
    against[current.name] = event.target.value;
    draw();
});
new ResizeObserver(() => draw()).observe(find("values-chart"));
choose(document.querySelector('input[name="quantity"]:checked').value);
