"""`shadefit new`: write a commented problem file, to be changed into one's own."""

import keyword
import re
from pathlib import Path
from typing import Annotated

import typer

_AXIS = re.compile(r"^([A-Za-z_][A-Za-z0-9_]*)=([^:]+):([^:]+)$")
_DEFAULT = ["x=0:1"]
_TEXT = '''"""{title}: a quantity of my own, for shadefit.

shadefit evaluate -p {file} {name} {point}
shadefit refit -p {file} --norm linf --out tables
shadefit search -p {file} {name} --out search
shadefit export -p {file} tables/{name}.json --to hlsl
"""

import jax.numpy as jnp

from shadefit import Axis, Problem, powers, quadrature


def integrand(t, {arguments}):
    """The function under the integral: of the variable t, then of the axes. Use jax.numpy."""
    return jnp.exp(-t * {sum})


{variable} = Problem(
    "{name}",
    # The arguments, with their domains. More of an axis: symbol, unit ("rad"), meaning, scale.
    axes=[
{axes}
    ],
    # The exact values, here ∫₀¹ integrand dt. Instead: closed_form(f), hemisphere(f), sphere(f),
    # monte_carlo(f, …), or measured data: table("data.csv", x=[…], y="…").
    reference=quadrature(integrand, over=[(0, 1)]),
    symbol="{symbol}",
    definition="∫₀¹ exp(−t {sum}) dt",
    meaning="say in a few words what it is",
    shader="{shader}",
)


# A form is a plain function. Arguments named like axes are axes, all others are coefficients, which
# begin at `start`. The docstring is the equation.
@{variable}.form(start=[1.0, 0.5])
def short({arguments}, a, b):
    """a/(1 + b z), z = {sum}"""
    return a / (1 + b * {sum})


# Quotients of polynomials, of degrees 1 and 2: their starts are found.
for degree in (1, 2):
    some = powers(degree{variables})
    {variable}.rational(some, some, name=f"rational-{{degree}}")
'''


def new(
    name: Annotated[str, typer.Argument(help="Name of the quantity: letters, digits, - and _.")],
    axes: Annotated[
        list[str] | None,
        typer.Option(help="An axis with its domain, as in eta=1:3; may be given again."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for NAME.py.")] = Path(),
) -> None:
    """Write NAME.py, a commented problem file that works as it is."""
    from coefficients.files import require_writable, write_whole
    from shadefit.terminal import print_lines

    if not re.fullmatch(r"[a-z][a-z0-9_-]{0,39}", name):
        raise ValueError(
            f"{name!r} is no name: allowed are a letter and up to 39 of a-z, 0-9, - and _"
        )
    path = out / f"{name.replace('-', '_')}.py"
    if path.exists():
        raise ValueError(f"{path} exists already: it is not replaced")
    text = problem_file(name, axes or _DEFAULT, path.name)
    require_writable(out)
    write_whole(path, text)
    print_lines(path)


def problem_file(name: str, axes: list[str], file: str) -> str:
    """Return a problem file's text. Raises ValueError for an axis that is not NAME=LOW:HIGH."""
    found = [_axis(text) for text in axes]
    names = [axis for axis, _, _ in found]
    for each in names:
        if names.count(each) > 1:
            raise ValueError(f"--axes: {each} is there twice")
    variable = name.replace("-", "_")
    taken = {*names, "short", "integrand", "some", "degree", "powers", "quadrature", "jnp"}
    if keyword.iskeyword(variable) or variable in taken:
        variable = f"{variable}_problem"
    title = "".join(part[:1].upper() + part[1:] for part in re.split("[-_]", name))
    return _TEXT.format(
        title=title,
        file=file,
        name=name,
        point=" ".join(f"--{n.replace('_', '-')} {(low + high) / 2:g}" for n, low, high in found),
        arguments=", ".join(names),
        sum=names[0] if len(names) == 1 else f"({' + '.join(names)})",
        variable=variable,
        axes="\n".join(f'        Axis("{n}", {low!r}, {high!r}),' for n, low, high in found),
        symbol=name,
        shader=title,
        variables="" if len(found) == 1 else f", {len(found)}, total=True",
    )


def _axis(text: str) -> tuple[str, float, float]:
    match = _AXIS.match(text)
    if match is None:
        raise ValueError(f"--axes {text}: allowed is NAME=LOW:HIGH, as in eta=1:3")
    name = match[1]
    if keyword.iskeyword(name) or name in ("a", "b", "t") or re.fullmatch(r"[ct]\d+", name):
        raise ValueError(f"--axes {text}: {name} is taken: allowed is another name")
    try:
        low, high = float(match[2]), float(match[3])
    except ValueError:
        raise ValueError(f"--axes {text}: {match[2]} and {match[3]} have to be numbers") from None
    if not float("-inf") < low < high < float("inf"):
        raise ValueError(f"--axes {text}: allowed are finite numbers, the first one less")
    return name, low, high
