"""What the code of an NDF costs, and how wrong lookups in textures would be instead."""

from dataclasses import dataclass

import numpy as np

from coefficients.ndf_code import ndf_of
from coefficients.ndf_table import NdfBlendTable, NdfTable
from programs import Function, Program, count_operations, evaluate, trace
from quantities.piecewise.code import ndf_functions
from shading.piecewise.ndf import Profile

# Texels along each axis of the textures.
SIZES = (32, 128)
_POINTS = 6000


@dataclass(frozen=True)
class Lookup:
    """A texture of `texels`, interpolated linearly, and its largest error at random points."""

    texels: int
    error: float


@dataclass(frozen=True)
class FunctionCost:
    """The cost of one exported function.

    `operations` are those of its code. `rounding` is the largest error of that code in float32, and
    `lookups` are the errors of textures of its result over `axes`, in the unit of the result. A
    function has no lookups if a texture of it is not useful: `axes` is then empty.
    """

    name: str
    operations: int
    rounding: float
    axes: str
    lookups: tuple[Lookup, ...]


def ndf_costs(table: NdfTable | NdfBlendTable) -> list[FunctionCost]:
    """Return the cost of each exported function of an NDF.

    The exact values are those of the code in float64. Textures of an isotropic NDF are over the
    cosine or the random number that the function takes; that of visible normals has 1 − cos θ over
    NdotV and u1. A blend has no textures here.
    """
    ndf = ndf_of(table)
    return [_cost(each, isinstance(ndf, Profile)) for each in ndf_functions(ndf)]


def _cost(function: Function, isotropic: bool) -> FunctionCost:
    program = trace(function)
    rng = np.random.default_rng(0)
    low, high = np.array([each.domain for each in function.parameters], float).T
    points = rng.uniform(low, high, (_POINTS, len(low)))
    names = [each.name for each in function.parameters]
    if "Vx" in names or "Hx" in names:
        points[:, :3] /= np.linalg.norm(points[:, :3], axis=1, keepdims=True)
    single = points.astype(np.float32).astype(float)
    apart = _values(program, single, np.float32) - _values(program, single, np.float64)
    lookups, axes = (), ""
    if isotropic and len(names) == 1:
        axes = names[0]
        lookups = tuple(_along(program, points[:, 0], size) for size in SIZES)
    elif isotropic and names[-1] == "u2":
        axes = "NdotV, u1: 1 - cos"
        lookups = tuple(_of_drops(program, points, size) for size in SIZES)
    return FunctionCost(
        function.name,
        count_operations(program).operations,
        float(np.abs(apart).max()),
        axes,
        lookups,
    )


def _values(program: Program, rows: np.ndarray, dtype=np.float64) -> np.ndarray:
    return np.asarray(evaluate(program, rows, dtype), float)


def _along(program: Program, at: np.ndarray, size: int) -> Lookup:
    """Return a texture over one argument in [0, 1]."""
    places = np.linspace(0, 1, size)
    found = np.interp(at, places, _values(program, places[:, None]).reshape(-1))
    gap = found - _values(program, at[:, None]).reshape(-1)
    return Lookup(size, float(np.abs(gap).max()))


def _of_drops(program: Program, points: np.ndarray, size: int) -> Lookup:
    """Return a texture of 1 − cos θ of visible normals over NdotV and u1; u2 has no influence."""
    line = np.linspace(0, 1, size)
    height, first = (each.ravel() for each in np.meshgrid(line, line, indexing="ij"))
    texels = _drops(program, height, first).reshape(size, size)
    at, xi = points[:, 2], points[:, 3]
    x, y = at * (size - 1), xi * (size - 1)
    i, j = (np.minimum(each.astype(int), size - 2) for each in (x, y))
    a, b = x - i, y - j
    found = (1 - a) * ((1 - b) * texels[i, j] + b * texels[i, j + 1]) + a * (
        (1 - b) * texels[i + 1, j] + b * texels[i + 1, j + 1]
    )
    return Lookup(size * size, float(np.abs(found - _drops(program, at, xi)).max()))


def _drops(program: Program, height: np.ndarray, first: np.ndarray) -> np.ndarray:
    across = np.sqrt((1 - height) * (1 + height))
    rows = np.stack([across, 0 * height, height, first, 0 * height + 0.3], axis=1)
    return 1 - _values(program, rows).reshape(-1, 3)[:, 2]
