"""How the quantities of GGX are called in shaders, and how they are drawn."""

from quantities.calling_convention import Argument, CallingConvention
from quantities.plot_hints import AxisHint, PlotHints

_VIEW = Argument("mu", "NdotV", clamp="both", local="NdotV")
_ROUGHNESS = Argument("alpha", "alpha", clamp="both", local="alpha")
_REMARK = "alpha is the width of GGX, the square of perceptual roughness"
ALPHA_HINT = AxisHint("α", 0.01, 1.0, 0.3, logarithmic=True)
MU_HINT = AxisHint("$v·n$", 0.0, 1.0, 0.3)


def calling(name: str, what: str, of_view: bool = True) -> CallingConvention:
    """Return the convention: arguments are clamped to the domain, and values to [0, 1].

    `what` is the summary of the function; `of_view` says whether it depends on the view.
    """
    return CallingConvention(
        name=name,
        summary=f"{what} ({{equation}}); clamps to the domain.",
        arguments=(_VIEW, _ROUGHNESS) if of_view else (_ROUGHNESS,),
        remark=("NdotV = v·n of the view's direction v; " if of_view else "") + _REMARK,
        codomain=(0.0, 1.0),
    )


def hints(largest_error: float) -> PlotHints:
    """Return how a quantity of view and roughness is drawn."""
    return PlotHints(
        {"mu": MU_HINT, "alpha": ALPHA_HINT},
        values=(0.0, 1.0),
        largest_error=largest_error,
        azimuth=50.0,
        surface_nodes=61,
        map_nodes=121,
    )
