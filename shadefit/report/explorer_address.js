// The state of the explorer in the address, after "#", so that a place can be kept or sent.
// What is read may come from anybody: unknown names and wrong values are left out.

const CHOICES = { errors: ["automatic", "linear", "logarithmic"], maps: ["automatic", "common", "own"] };
// What is chosen from CHOICES, and what code is shown.
const choices = { errors: "automatic", maps: "automatic", code: "", language: known.languages[0].key };

function addressOf() {
    const said = new URLSearchParams({ quantity: current.name });
    for (const axis of current.axes) said.append(`at.${axis.name}`, shownText(axis));
    said.append("against", against[current.name]);
    for (const { name } of chosenTables()) said.append("table", name);
    if (!chosenTables().length) said.append("table", "");
    for (const [name, value] of Object.entries(choices)) said.append(name, value);
    return `#${said.toString().replaceAll("%2F", "/")}`;
}

// Sets the state to that of an address. Returns what is wrong with values, by the axis, or null if
// the address has no state.
function readAddress(address) {
    const said = new URLSearchParams(address.replace(/^#/, ""));
    if (!Object.hasOwn(quantities, said.get("quantity") ?? "")) return null;
    select(said.get("quantity"));
    const wrong = {};
    for (const axis of current.axes) {
        const text = said.get(`at.${axis.name}`);
        const message = text === null ? "" : enterText(axis, text);
        if (message) wrong[axis.name] = message;
    }
    if (axisOf(said.get("against"))) against[current.name] = said.get("against");
    const tables = said.getAll("table");
    // An empty name stands for no table.
    if (tables.includes("") || current.tables.some(({ name }) => tables.includes(name)))
        for (const { name } of current.tables)
            shown[tables.includes(name) ? "add" : "delete"](name);
    for (const [name, allowed] of Object.entries(CHOICES))
        if (allowed.includes(said.get(name))) choices[name] = said.get(name);
    const language = known.languages.find((each) => each.key === said.get("language"));
    if (language) choices.language = language.key;
    const code = codes[current.name].find((each) => each.name === said.get("code"));
    if (code) choices.code = code.name;
    return wrong;
}
