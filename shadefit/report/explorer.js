// The page: controls, numbers, and when they are drawn anew.

const WAIT = 500; // milliseconds without a change before the values are read out

// Each row has a box to draw the table, a sample of its line, its value, and its error.
function fillTable() {
    const exact = hasExact(current) ? [{ name: "exact", kind: "exact" }] : [];
    const rows = [...exact, ...current.tables].map((table) => {
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
    const truth = exactAt(point);
    const said = [];
    for (const row of find("values").rows) {
        const table = current.tables.find((each) => each.name === row.dataset.table);
        const value = table ? evaluate(table, point) : truth;
        const [, number, error] = row.cells;
        number.textContent = Number.isFinite(value) ? value.toFixed(8) : "—";
        number.className = Number.isFinite(value) ? "number" : "faint";
        const name = table ? table.name : `${current.symbol} exact`;
        if (!table || shown.has(table.name)) said.push(`${name} ${value.toFixed(4)}`);
        if (!table) continue;
        const missed = outside(table, point);
        const off = value - truth;
        error.className = missed ? "faint" : "number";
        error.textContent = [
            Number.isFinite(off) ? `${off < 0 ? "−" : "+"}${Math.abs(off).toExponential(2)}` : "—",
            ...(missed ? [`${missed} outside its domain`] : []),
        ].join("; ");
    }
    clearTimeout(updateValues.timer);
    updateValues.timer = setTimeout(() => { find("status").textContent = said.join("; "); }, WAIT);
}

// A control for an axis: a slider and a number field, both in the shown unit.
function control(axis) {
    const { name, low, high, factor, unit } = axis;
    const group = document.createElement("div");
    group.className = "control";
    const label = document.createElement("label");
    label.htmlFor = `slide-${name}`;
    label.textContent = `${axis.symbol}, ${axis.meaning}`;
    const [range, number] = ["range", "number"].map((type) => {
        const input = document.createElement("input");
        input.type = type;
        input.min = low * factor;
        input.max = high * factor;
        input.step = "any";
        return input;
    });
    range.id = `slide-${name}`;
    range.step = unit === "°" ? 0.5 : stepOf((high - low) * factor);
    number.id = `enter-${name}`;
    number.setAttribute("aria-label", `${axis.symbol} as a number`);
    const set = (text, source) => {
        const entered = Number.parseFloat(text);
        const fits = entered >= Number(number.min) - 1e-9 && entered <= Number(number.max) + 1e-9;
        number.setAttribute("aria-invalid", String(!fits));
        if (!fits) return;
        state[name] = Math.min(Math.max(entered / factor, low), high);
        if (source !== range) range.value = entered;
        if (source !== number) number.value = String(Number(entered.toPrecision(6)));
        range.setAttribute("aria-valuetext", `${number.value}${unit}`);
        draw();
    };
    range.addEventListener("input", () => set(range.value, range));
    number.addEventListener("input", () => set(number.value, number));
    group.append(label, range, number, unit);
    set(String(state[name] * factor), null);
    return group;
}

// The step of a slider over a range of this width: a power of ten, about a thousandth of the range.
function stepOf(width) {
    return 10 ** Math.round(Math.log10(width / 1000));
}

function choose(name) {
    select(name);
    find("controls").replaceChildren(...current.axes.map(control));
    const choice = find("against");
    choice.replaceChildren(...current.axes.map((axis) => {
        const selected = axis.name === against[name];
        return new Option(`${axis.symbol}, ${axis.meaning}`, axis.name, selected, selected);
    }));
    fillTable();
    draw();
}

// Numbers change at once; pictures at most once a frame, even if a slider moves faster.
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
