"""The error of forms of R in interval arithmetic, for proofs of the largest error.

R has no closed form. It is replaced by polynomials that are proven to be near it (`r_patches.py`).
"""

from collections.abc import Iterable

import numpy as np

from fitting.form import FittedForm
from fitting.proofs.largest_error import ErrorCode, printed
from integrals.reference import box_of
from programs.bounding.compiled import compiler_missing
from quantities.fuzz.ps_error import KERNEL
from quantities.fuzz.r_patches import Patches, patches

# The polynomials differ from R by so much at most.
TOLERANCE = 1e-8
# The work grows as the least α to the power −3. Here it takes 80 seconds on one core.
LEAST_ALPHA = 0.05

_ENTRY = """
static jet error_at(boxes *K, const jet *x) {
    return add2(K, form(K, x[0], x[1]), negative(K, patched(K, x[0], x[1])));
}
"""


def _array(name: str, numbers: Iterable[float]) -> str:
    return f"static const double {name} = {{{', '.join(float(x).hex() for x in numbers)}}};"


def patches_code(found: Patches) -> str:
    """Write polynomials as tables in C, for `kernel/patches.h`."""
    count, by_alpha, by_theta = found.powers.shape
    first = ", ".join(str(k) for k in found.slab_first)
    return "\n".join(
        (
            f"#define SLABS {len(found.slab_ends)}",
            f"#define BY_X {by_alpha}",
            f"#define BY_Y {by_theta}",
            f"#define END_Y {np.pi / 2!r}",
            _array("slab_end[SLABS]", found.slab_ends),
            f"static const int slab_first[SLABS + 1] = {{{first}}};",
            _array(f"patch_place[{count}][4]", found.places.ravel()),
            _array(f"patch_powers[{count}][BY_X * BY_Y]", found.powers.ravel()),
        )
    )


def error_code(fitted: FittedForm) -> ErrorCode | None:
    """Return the code of R̃ − R; None for a form whose domain contains α below `LEAST_ALPHA`.

    This computes about ten thousand values of R. Raises ValueError without a C compiler.
    """
    alpha = fitted.axes[0]
    if alpha.lower < LEAST_ALPHA:
        return None
    reason = compiler_missing()
    if reason is not None:
        raise ValueError(f"the proof needs a C compiler: {reason}")
    found = patches(alpha.lower, alpha.upper, TOLERANCE)

    def value(alpha, theta_f):
        return fitted.form(fitted.constants, alpha, theta_f)

    parts = (
        printed("form", ("alpha", "theta_f"), value),
        patches_code(found),
        (KERNEL / "patches.h").read_text("utf-8"),
        _ENTRY,
    )
    return ErrorCode(parts, box_of(fitted.axes), inexact=found.error)
