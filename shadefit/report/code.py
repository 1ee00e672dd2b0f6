"""The shader code that the explorer shows: each table and closed form in some languages."""

import shlex
from collections.abc import Sequence

from coefficients.catalogue import EXACT, Entry, resolve
from coefficients.code_equation import code_equation
from coefficients.exported_code import LICENCE, LICENCE_LABEL
from coefficients.proof_text import proofs
from programs import write_source
from programs.toolchains.difference import Difference, text_of
from quantities import Problem
from quantities.loader import option_for

LISTED = ("hlsl", "glsl", "glsl-es", "wgsl", "metal", "cpp")


def codes(owner: Problem, own: Sequence[Entry]) -> list[dict]:
    """Return the code of a quantity's tables, and of its closed form if that is exported.

    Each has the `name` of its entry, its `texts` by the key of a language, `refusals` that say why
    there is none in a language, and the `command` that exports it, without the language.
    """
    exact = [] if owner.exact_code is None else [resolve(f"{EXACT}/{owner.name}")]
    return [_code(entry) for entry in (*own, *exact)]


def _code(entry: Entry) -> dict:
    texts, refusals = {}, {}
    functions, header = entry.functions("float"), _header(entry)
    for key in LISTED:
        try:
            texts[key] = write_source(functions, key, header=header)
        except ValueError as error:
            refusals[key] = str(error)
    command = shlex.join(["shadefit", "export", *option_for(entry.problem), entry.name])
    return {"name": entry.name, "texts": texts, "refusals": refusals, "command": command}


def _header(entry: Entry) -> dict[str, str]:
    """Return the comment above the code: what is known about it without running it."""
    head = {LICENCE_LABEL: LICENCE, "Quantity": entry.problem.description}
    head["Equation"] = code_equation(entry)
    if entry.remark:
        head["Arguments"] = entry.remark
    if entry.table is not None:
        proven = proofs(entry)
        if proven:
            head["Proven in exact arithmetic"] = "; ".join(proven)
        if entry.table.errors is not None:
            stated = entry.table.errors.off_grid
            own = text_of(Difference(stated.max, stated.rms))
            head["Error in exact arithmetic"] = f"{own}, as the table states"
    return head
