"""The fits of `shadefit fit --shared-denominator`."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from shadefit.declaration import Problem
    from shadefit.result import Result

# What a goal may have: one denominator is known for these only.
_FIELDS = ("norm", "relative", "rounding")


def shared_fits(
    owners: "Sequence[Problem]", texts: list[str], goal: dict[str, Any], command: str
) -> "list[Result]":
    """Fit several columns by the rational forms that one text such as 'rational:2,2' describes.

    Raises ValueError for another form, for several forms, and for what a goal may not have.
    """
    from fitting.shapes.monomial_sums import powers
    from shadefit.progress import stages
    from shadefit.shared_denominator import fit_with_shared_denominator

    kind, _, numbers = texts[0].partition(":")
    counts = [int(each) for each in numbers.split(",") if each.isdecimal()]
    if len(texts) > 1 or kind != "rational" or f"rational:{','.join(map(str, counts))}" != texts[0]:
        raise ValueError(
            f"--form {' '.join(texts)}: allowed with --shared-denominator is one, rational:M,N"
        )
    if len(counts) != 2:
        raise ValueError(f"--form {texts[0]}: allowed are 2 numbers after rational:")
    for field in goal:
        if field not in _FIELDS:
            allowed = ", ".join(f"--{each}" for each in _FIELDS)
            raise ValueError(f"--{field}: allowed with --shared-denominator are {allowed}")
    above, below = (powers(count, len(owners[0].axes), total=True) for count in counts)
    options = "".join(f" --{k}" if v is True else f" --{k} {v}" for k, v in goal.items())
    with stages() as progress:
        progress.begin(f"{', '.join(each.name for each in owners)}: {texts[0]}")
        return fit_with_shared_denominator(
            owners,
            above,
            below,
            name=texts[0].replace(":", "-").replace(",", "-"),
            command=f"{command} --form {texts[0]}{options}",
            **goal,
        )
