"""The fits of `shadefit fit --shared-denominator`."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from shadefit.commands.form_texts import form_name, parsed_form, with_form

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

    kind, counts = parsed_form(texts[0], len(owners[0].axes))
    if len(texts) > 1 or kind != "rational":
        raise ValueError(
            f"--form {' '.join(texts)}: allowed with --shared-denominator is one, rational:M,N"
        )
    for field in goal:
        if field not in _FIELDS:
            allowed = ", ".join(f"--{each}" for each in _FIELDS)
            raise ValueError(f"--{field}: allowed with --shared-denominator are {allowed}")
    above, below = (powers(count, len(owners[0].axes), total=True) for count in counts)
    with stages() as progress:
        progress.begin(f"{', '.join(each.name for each in owners)}: {texts[0]}")
        return fit_with_shared_denominator(
            owners,
            above,
            below,
            name=form_name(texts[0]),
            command=with_form(command, texts[0], goal),
            **goal,
        )
