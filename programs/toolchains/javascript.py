"""JavaScript, run by Node."""

import json

import numpy as np

from programs.functions import Function
from programs.toolchains.interface import compile_failure, result_count, run_failure
from programs.toolchains.native import values_from
from programs.toolchains.process import execute, first_line, missing_command, workspace

NOTE = "JavaScript computes in double only."

_MAIN = """
const shadefitNode = require("node:fs");
const shadefitWidths = {widths};
const shadefitNested = {nested};
const shadefitCount = {count};
const shadefitBytes = shadefitNode.readFileSync("inputs");
const shadefitRows = new Float64Array(
    shadefitBytes.buffer.slice(
        shadefitBytes.byteOffset, shadefitBytes.byteOffset + shadefitBytes.length));
const shadefitWidth = shadefitWidths.reduce((sum, width) => sum + (width || 1), 0);
const shadefitTotal = shadefitRows.length / shadefitWidth;
const shadefitOut = new Float64Array(shadefitTotal * shadefitCount);
for (let row = 0; row < shadefitTotal; ++row) {{
    let at = row * shadefitWidth;
    const call = shadefitWidths.map((width, place) => {{
        const from = at;
        at += width || 1;
        if (!width) return shadefitRows[from];
        const given = Array.from(shadefitRows.subarray(from, at));
        if (!shadefitNested[place]) return given;
        return given.filter((_, k) => k % 3 === 0).map((_, k) => given.slice(3 * k, 3 * k + 3));
    }});
    const value = {name}(...call);
    const values = Array.isArray(value) ? value.flat() : [value];
    if (values.length !== shadefitCount || values.some((one) => typeof one !== "number"))
        throw new TypeError("{name} gave " + JSON.stringify(value));
    shadefitOut.set(values, row * shadefitCount);
}}
shadefitNode.writeFileSync("values", new Uint8Array(shadefitOut.buffer));
"""


def missing_reason(precision: str) -> str | None:
    """See `Toolchain.missing_reason`."""
    if precision != "double":
        return "JavaScript computes in double only"
    return missing_command("node", "nodejs")


def evaluate(source: str, function: Function, inputs: np.ndarray, precision: str) -> np.ndarray:
    """See `Toolchain.evaluate`."""
    widths = json.dumps([parameter.size or 0 for parameter in function.parameters])
    nested = json.dumps([parameter.shape == "vectors" for parameter in function.parameters])
    count = result_count(function)
    main = _MAIN.format(widths=widths, nested=nested, count=count, name=function.name)
    failure = run_failure("JavaScript", function, precision)
    with workspace() as folder:
        (folder / "code.js").write_text(source, encoding="utf-8")
        execute(
            ["node", "--check", "code.js"],
            failure=compile_failure("JavaScript", function, precision),
            folder=folder,
        )
        # Code and main program are one file: a module does not see the functions of a script.
        (folder / "main.js").write_text(source + main, encoding="utf-8")
        (folder / "inputs").write_bytes(inputs.tobytes())
        execute(["node", "main.js"], failure=failure, folder=folder)
        data = (folder / "values").read_bytes()
    return values_from(data, len(inputs), function, failure)


def versions() -> str:
    """See `Toolchain.versions`."""
    return f"Node {first_line('node', '--version')}"
