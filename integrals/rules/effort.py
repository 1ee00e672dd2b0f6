"""How much work an adaptive rule may do, and how many values it needs at once."""

from typing import Any, NamedTuple


class Effort(NamedTuple):
    """How much work an adaptive rule may do.

    A box has `nodes` nodes in each variable. There are at least `panels` boxes along each variable
    at the start. Each of at most `steps` steps halves the `splits` worst boxes. The rule stops
    earlier when the error is at most `tolerance` times the integral of |integrand|.
    """

    nodes: int
    panels: int
    steps: int
    splits: int
    tolerance: float


# By the number of variables. In one variable, 128 nodes at the start find a peak with a standard
# deviation of 1e-3 of the interval. More variables have fewer nodes in each, as their product
# counts, and a wider tolerance, as their errors are overestimated more.
DEFAULTS = {
    1: Effort(nodes=16, panels=8, steps=48, splits=2, tolerance=1e-13),
    2: Effort(nodes=16, panels=4, steps=48, splits=4, tolerance=1e-7),
    3: Effort(nodes=8, panels=2, steps=32, splits=8, tolerance=1e-6),
    4: Effort(nodes=6, panels=2, steps=16, splits=8, tolerance=1e-4),
}

# The numbers that are allowed: the smallest and the largest.
_ALLOWED = {"nodes": (4, 64), "panels": (1, 256), "steps": (0, 1024)}


def effort_of(variables: int, **given: int | float | None) -> Effort:
    """Return the default effort for a number of variables, with what is `given` and not None.

    Raises ValueError if there are no defaults for so many variables, or a number is out of range.
    """
    if variables not in DEFAULTS:
        raise ValueError(
            f"{variables} variables of integration: allowed are 1 to {max(DEFAULTS)}; "
            "Monte Carlo takes more"
        )
    changes: dict[str, Any] = {name: value for name, value in given.items() if value is not None}
    for name, (least, most) in _ALLOWED.items():
        if name in changes and not least <= changes[name] <= most:
            raise ValueError(f"{name} = {changes[name]}: allowed are {least} to {most}")
    if not changes.get("tolerance", 1) > 0:
        raise ValueError(f"tolerance = {changes['tolerance']}: it has to be positive")
    return DEFAULTS[variables]._replace(**changes)


def evaluations_at_once(effort: Effort, variables: int) -> int:
    """Return how many values of the integrand one point needs in memory at the same time."""
    boxes = max(effort.panels**variables, 2 * effort.splits)
    faces = 4 * variables * effort.nodes ** (variables - 1)
    return boxes * (effort.nodes**variables + fewer(effort.nodes) ** variables + faces)


def fewer(nodes: int) -> int:
    """Return the number of nodes of the rule that another one is compared with."""
    return 3 * nodes // 4
