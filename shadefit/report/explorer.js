// The page: controls, numbers, and when they are drawn anew.

const WAIT = 500; // milliseconds without a change before values are read out and kept in the address

const controls = {}; // of the current axes, by name: { show, say }

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
        if (table.kind !== "exact") label.append(boxOf(table));
        label.append(swatch, ` ${table.name}`);
        head.append(label);
        row.append(head, document.createElement("td"), document.createElement("td"));
        return row;
    });
    find("values").replaceChildren(...rows);
}

function boxOf(table) {
    const box = document.createElement("input");
    box.type = "checkbox";
    box.checked = shown.has(table.name);
    box.addEventListener("change", () => {
        shown[box.checked ? "add" : "delete"](table.name);
        if (box.checked && codeOf(table.name)) {
            choices.code = table.name;
            showCode();
        }
        draw();
    });
    return box;
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
    updateValues.timer = setTimeout(() => {
        find("status").textContent = said.join("; ");
        keepAddress();
    }, WAIT);
}

function keepAddress() {
    const address = addressOf();
    if (address === keepAddress.last) return;
    keepAddress.last = address;
    try {
        history.replaceState(null, "", address);
    } catch {
        // A browser may not allow this for a file.
        location.replace(address);
    }
}

// A control for an axis: a slider and a number field, both in the shown unit, and what is wrong with
// the number. A slider over a logarithmic axis is one of the logarithm.
function control(axis) {
    const { name, low, high, factor, unit, logarithmic } = axis;
    const [toSlider, fromSlider] = logarithmic ? [Math.log10, (place) => 10 ** place]
        : [(value) => value, (place) => place];
    const group = document.createElement("div");
    group.className = "control";
    const label = document.createElement("label");
    label.htmlFor = `slide-${name}`;
    label.textContent = axis.meaning ? `${axis.symbol}, ${axis.meaning}` : axis.symbol;
    const [range, number] = ["range", "number"].map((type) => {
        const input = document.createElement("input");
        input.type = type;
        return input;
    });
    range.id = `slide-${name}`;
    const ends = [toSlider(low * factor), toSlider(high * factor)];
    [range.min, range.max] = ends;
    range.step = unit === "°" ? 0.5 : stepOf(ends[1] - ends[0]);
    number.id = `enter-${name}`;
    number.step = "any";
    number.setAttribute("aria-label", `${axis.symbol} as a number`);
    number.setAttribute("aria-describedby", `message-${name}`);
    const message = document.createElement("p");
    message.id = `message-${name}`;
    message.className = "message";
    message.setAttribute("role", "alert");
    const say = (text) => {
        message.textContent = text;
        number.setAttribute("aria-invalid", String(text !== ""));
    };
    // Shows the value of the state in all inputs but the one that is being used.
    const show = (source = null) => {
        if (source !== range) range.value = toSlider(state[name] * factor);
        if (source !== number) number.value = shownText(axis);
        range.setAttribute("aria-valuetext", `${shownText(axis)}${unit}`);
        say("");
    };
    range.addEventListener("input", () => {
        const entered = Number(fromSlider(Number(range.value)).toPrecision(logarithmic ? 3 : 12));
        state[name] = Math.min(Math.max(entered / factor, low), high);
        show(range);
        draw();
    });
    number.addEventListener("input", () => {
        const wrong = enterText(axis, number.value);
        if (wrong) say(wrong);
        else {
            show(number);
            draw();
        }
    });
    group.append(label, range, number, unit, message);
    show();
    controls[name] = { show, say };
    return group;
}

// The step of a slider over a range of this width: a power of ten, about a thousandth of the range.
function stepOf(width) {
    return 10 ** Math.round(Math.log10(width / 1000));
}

// Sets a place of the upper or lower chart, or of a disc, while the pointer is down.
function followPointer(container, set) {
    container.addEventListener("pointerdown", (event) => {
        if (event.button !== 0) return;
        if (event.pointerType === "mouse") event.preventDefault();
        container.setPointerCapture(event.pointerId);
        if (set(event)) showPlace();
    });
    container.addEventListener("pointermove", (event) => {
        if (container.hasPointerCapture(event.pointerId) && set(event)) showPlace();
    });
}

function showPlace() {
    for (const { name } of current.axes) controls[name].show();
    draw();
}

function setOnChart(container, event) {
    moveAlong(against[current.name], container.toPlace(event.clientX));
    return true;
}

function setOnDisc(event) {
    // While the pointer is down, its events are those of the container.
    if (event.type === "pointerdown") setOnDisc.canvas = event.target.closest("canvas");
    const { canvas } = setOnDisc;
    if (!canvas) return false;
    const { left, top, width } = canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - left, event.clientY - top].map((d) => (2 * d) / width - 1);
    for (const [name, value] of Object.entries(directionAt(x, -y))) {
        const { low, high } = axisOf(name);
        state[name] = Math.min(Math.max(value, low), high);
    }
    return true;
}

// Makes the controls of the current quantity.
function showQuantity() {
    for (const input of document.querySelectorAll('input[name="quantity"]'))
        input.checked = input.value === current.name;
    find("about").textContent = current.about;
    find("controls").replaceChildren(...current.axes.map(control));
    find("against").replaceChildren(...current.axes.map(({ name, symbol, meaning }) =>
        new Option(meaning ? `${symbol}, ${meaning}` : symbol, name, false,
            name === against[current.name])));
    find("no-exact").textContent = `The page has no formula for the exact values of `
        + `${current.symbol}. The summary has the errors of the tables.`;
    find("errors").value = choices.errors;
    find("maps").value = choices.maps;
    fillTable();
    fillCodes();
    draw();
}

// Takes the state from the address, unless this page has just written it there.
function restore() {
    if (location.hash === keepAddress.last) return true;
    const wrong = readAddress(location.hash);
    if (wrong === null) return false;
    showQuantity();
    for (const [name, message] of Object.entries(wrong)) controls[name].say(message);
    return true;
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

function start() {
    for (const input of document.querySelectorAll('input[name="quantity"]'))
        input.addEventListener("change", () => {
            select(input.value);
            showQuantity();
        });
    find("against").addEventListener("change", (event) => {
        against[current.name] = event.target.value;
        draw();
    });
    for (const name of ["errors", "maps"])
        find(name).addEventListener("change", (event) => {
            choices[name] = event.target.value;
            draw();
        });
    for (const [id, name] of [["code-of", "code"], ["code-in", "language"]])
        find(id).addEventListener("change", (event) => {
            choices[name] = event.target.value;
            showCode();
            keepAddress();
        });
    find("code-in").replaceChildren(...known.languages.map(({ key, name }) => new Option(name, key)));
    find("copy").addEventListener("click", copyCode);
    for (const id of ["values-chart", "errors-chart"])
        followPointer(find(id), (event) => setOnChart(find(id), event));
    followPointer(find("discs"), setOnDisc);
    new ResizeObserver(() => draw()).observe(find("values-chart"));
    addEventListener("hashchange", restore);
    if (restore()) return;
    select(current.name);
    showQuantity();
    // The address stays as it is until something is changed.
    keepAddress.last = addressOf();
}

start();
