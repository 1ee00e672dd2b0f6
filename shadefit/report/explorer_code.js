// The shader code of the table one looks at, and a button that copies it.

function codeOf(name) {
    return codes[current.name].find((each) => each.name === name);
}

// Offers the codes of the current quantity. Without a choice it is that of the best drawn table.
function fillCodes() {
    const own = codes[current.name];
    find("code").hidden = !own.length;
    if (!own.length) return;
    if (!codeOf(choices.code))
        choices.code = (codeOf(current.code) ?? own[0]).name;
    find("code-of").replaceChildren(...own.map(({ name }) =>
        new Option(name, name, false, name === choices.code)));
    showCode();
}

function showCode() {
    const { name, texts, refusals, command } = codeOf(choices.code);
    const text = texts[choices.language];
    find("code-of").value = name;
    find("code-in").value = choices.language;
    find("code-text").textContent = text ?? refusals[choices.language];
    find("copy").disabled = text === undefined;
    find("copied").textContent = "";
    find("code-command").textContent = `${command} --to ${choices.language}`;
}

// Without the permission to write to the clipboard, the code is selected.
async function copyCode() {
    const text = find("code-text");
    try {
        await navigator.clipboard.writeText(text.textContent);
        find("copied").textContent = "Copied.";
    } catch {
        getSelection().selectAllChildren(text);
        const done = document.execCommand("copy");
        find("copied").textContent = done ? "Copied."
            : "The browser does not allow it. The code is selected: copy it with the keyboard.";
    }
}
