"""Tables of fitted NDFs."""

from coefficients.ndf_table import (
    BLEND_SCHEMA,
    SCHEMA,
    BlendProfile,
    NdfBlendTable,
    NdfErrors,
    NdfTable,
)
from quantities.piecewise.blend_fit import BlendFit
from quantities.piecewise.fit import NdfFit
from shading.piecewise.ndf import Profile


def table_of(fit: NdfFit, command: str) -> NdfTable:
    """Return the table of a fit; `command` makes it again."""
    return NdfTable(
        schema=SCHEMA,
        target=fit.target,
        linear_in=_kind(fit.profile),
        monotone=fit.monotone,
        knots=[float(each) for each in fit.profile.knots],
        values=[float(each) for each in fit.profile.values],
        mass=fit.mass,
        errors=_errors(fit),
        command=command,
    )


def table_of_blend(fit: BlendFit, command: str) -> NdfBlendTable:
    """Return the table of a blend that was fitted to an anisotropic NDF."""
    return NdfBlendTable(
        schema=BLEND_SCHEMA,
        target=fit.target,
        linear_in=_kind(fit.blend.x),
        monotone=fit.monotone,
        x=_profile(fit.blend.x, fit.masses[0]),
        y=_profile(fit.blend.y, fit.masses[1]),
        errors=_errors(fit),
        command=command,
    )


def table_of_two(x: NdfFit, y: NdfFit, command: str) -> NdfBlendTable:
    """Return the table of the blend of two fits, `x` at azimuth 0 and `y` at π/2."""
    return NdfBlendTable(
        schema=BLEND_SCHEMA,
        target=f"{x.target} and {y.target}",
        linear_in=_kind(x.profile),
        monotone=x.monotone,
        x=_profile(x.profile, x.mass),
        y=_profile(y.profile, y.mass),
        errors=None,
        command=command,
    )


def _profile(ndf: Profile, mass: float) -> BlendProfile:
    return BlendProfile(
        knots=[float(each) for each in ndf.knots],
        values=[float(each) for each in ndf.values],
        mass=mass,
    )


def _errors(fit: NdfFit | BlendFit) -> NdfErrors:
    return NdfErrors(
        total_variation=fit.total_variation,
        masking=fit.masking_error,
        directions=fit.directions,
    )


def _kind(ndf: Profile):
    return "cos2" if ndf.variable == "cos2" else "angle"
