"""The quantity P_s: the part of the scattered light that goes down to the base."""

import jax.numpy as jnp
import numpy as np

import integrals
from fitting.proofs.rounding_error import TracedArguments
from integrals.fuzz.ps import fraction_at
from integrals.reference import restricted
from programs.functions import Function, Parameter, Record, function
from quantities.calling_convention import MATERIAL, Argument, CallingConvention, clamped
from quantities.family import Family
from quantities.fuzz.lights import cosines_at
from quantities.fuzz.material import COS_PHI, bounded_cosines
from quantities.fuzz.ps_error import error_code
from quantities.fuzz.ps_forms import MAX_DEGREE, candidates, cubic_ps, one_root_ps, two_root_ps
from quantities.fuzz.supplement import RATIONAL_PS
from quantities.plot_hints import AxisHint, HemisphereHint, PlotHints
from quantities.problem import ExactCode, Problem
from shading.fuzz.lit_cone import FLOAT32_STEPS, FLOAT64_STEPS, scattered_fraction

_COSINE = (0.0, 1.0)
_CLOSED_FORM = (
    "closed form: c = NdotU; a = TdotU; b = NdotT; κ = 1 − alpha²; m = alpha²·c; T = κ·a·b; "
    "σ2 = 1 − κ·a²; S = √(σ2·(1 − κ·b²)); P_s = 1 − root²·√((root + c)·(root + m/σ2))/"
    "(2·root³ + (m + 2·T)·root² + m), where root is the positive solution, by Newton's steps, of "
    "root·(root − S + T)·(root + S + T) = m·(1 − root²)"
)
# The error of the closed form in float32 is measured and stated for α from this on.
LEAST_EXACT_ALPHA = 0.05
# The code clamps α to this at least. Smaller fourth powers would leave the range of the precision.
_LEAST_ALPHA = {"half": LEAST_EXACT_ALPHA, "float": 1e-6, "double": 1e-6}


def exact_functions(precision: str) -> tuple[Function, ...]:
    """Return the closed form as a function of u·n, u·t, n·t and α.

    The precision ("half", "float" or "double") decides how many Newton steps compute the root.
    """

    def exact(cos_un, cos_ut, cos_nt, alpha):
        return _fraction(
            cos_un,
            cos_ut,
            clamped(cos_nt, -1.0, 1.0),
            clamped(alpha, _LEAST_ALPHA[precision], 1.0),
            precision,
        )

    parameters = (
        Parameter("NdotU", _COSINE),
        Parameter("TdotU", (-1.0, 1.0)),
        Parameter("NdotT", _COSINE),
        Parameter("alpha", (LEAST_EXACT_ALPHA, 1.0)),
    )
    summary = "P_s in closed form, without coefficients."
    return (function("FuzzPsExact", parameters, exact, summary),)


def staged_exact_functions(
    precision: str, record: Record, cosines: bool
) -> tuple[Function, Function]:
    """Return the closed form as two functions: of α and θf (or n·t), and of u·n and u·t.

    The first returns α and n·t in the structure, and the second takes it.
    """

    def material(alpha, fibre):
        cos_nt = clamped(fibre, *_COSINE) if cosines else jnp.cos(clamped(fibre, 0.0, np.pi / 2))
        return clamped(alpha, _LEAST_ALPHA[precision], 1.0), cos_nt

    def value(material, cos_un, cos_ut):
        return _fraction(cos_un, cos_ut, material[1], material[0], precision)

    fibre = Parameter("NdotT", _COSINE) if cosines else Parameter("thetaF", (0.0, np.pi / 2), "rad")
    first = (Parameter("alpha", (LEAST_EXACT_ALPHA, 1.0)), fibre)
    second = (
        Parameter(MATERIAL, (0.0, 1.0), size=2, record=record),
        Parameter("NdotU", _COSINE),
        Parameter("TdotU", (-1.0, 1.0)),
    )
    summary = "What FuzzPs needs to know of one material; clamps to the domain."
    return (
        function("FuzzPsMaterial", first, material, summary, 2, MATERIAL, record),
        function("FuzzPs", second, value, "P_s for one direction of light, in closed form."),
    )


def _cosines_of_proof(alpha, theta_f, theta_u, cos_phi):
    """Return the arguments of the closed form, of the variables of proofs."""
    return (*bounded_cosines(theta_f, theta_u, cos_phi), jnp.cos(theta_f), alpha)


def _fraction(cos_un, cos_ut, cos_nt, alpha, precision: str):
    """Return P_s in closed form for u·n and u·t that are not clamped yet."""
    steps = FLOAT64_STEPS if precision == "double" else FLOAT32_STEPS
    value = scattered_fraction(
        clamped(cos_un, *_COSINE), clamped(cos_ut, -1.0, 1.0), cos_nt, alpha, steps
    )
    return clamped(value, 0.0, 1.0)


PS = Problem(
    reference=integrals.PS,
    forms=(RATIONAL_PS,),
    families={
        "one-root-ps": Family(
            one_root_ps,
            {"skew": range(2), "degree": range(MAX_DEGREE + 1), "least_alpha": "fraction"},
        ),
        "two-root-ps": Family(
            two_root_ps,
            {"terms": range(3, 6), "degree": range(MAX_DEGREE + 1), "least_alpha": "fraction"},
        ),
        "cubic-ps": Family(
            cubic_ps,
            {"steps": range(5), "degree": range(-1, MAX_DEGREE + 1), "least_alpha": "fraction"},
        ),
    },
    candidates=lambda lower: candidates(lower["alpha"]),
    search_lower={"alpha": 0.15},
    calling=CallingConvention(
        name="FuzzPs",
        summary="P_s for one direction of light.",
        arguments=(
            Argument("alpha", "alpha", clamp="both", local="alpha"),
            Argument("theta_f", "thetaF", clamp="both", local="theta_f", cosine="NdotT"),
        ),
        remark="alpha, the roughness, is the projected area along the fibre t, thetaF its polar "
        "angle: turn t so that NdotT >= 0; NdotU = u·n and TdotU = u·t of the light's direction u. "
        "What is proven holds for cosines of unit vectors",
        second=(("NdotU", _COSINE), ("TdotU", (-1.0, 1.0))),
        columns=lambda points: np.stack(cosines_at(points)[:2], axis=1),
        # Cosines that belong to no unit vectors, and rounding, lead out of it.
        codomain=(0.0, 1.0),
        material="FuzzMaterial",
    ),
    closed_form=fraction_at,
    error_code=error_code,
    exact_code=ExactCode(
        _CLOSED_FORM,
        restricted(integrals.PS.axes, alpha=(LEAST_EXACT_ALPHA, 1.0)),
        exact_functions,
        lambda points: (np.stack([*cosines_at(points), points[:, 0]], axis=1),),
        "NdotU = u·n, TdotU = u·t, NdotT = n·t, all unit vectors; t and −t are one fibre: turn t "
        "so that NdotT >= 0",
        "none but what the root's steps leave",
        staged_exact_functions,
        TracedArguments(
            (*restricted(integrals.PS.axes[:3], alpha=(LEAST_EXACT_ALPHA, 1.0)), COS_PHI),
            _cosines_of_proof,
            (True, True, True, False),
        ),
    ),
    plot=PlotHints(
        {
            "alpha": AxisHint("α", 0.15, 1.0, 0.35, explored=(0.05, 1.0)),
            "theta_f": AxisHint(
                "fibre's angle $θ_f$",
                0.1,
                np.pi / 2,
                np.pi / 4,
                explored=(0.0, np.pi / 2),
                short_label="$θ_f$",
                factor=180 / np.pi,
                unit="°",
            ),
            "theta_u": AxisHint("$θ_u$", 0.0, np.pi / 2, np.pi / 6, factor=180 / np.pi, unit="°"),
            "phi": AxisHint("φ", -np.pi, np.pi, np.pi / 2, factor=180 / np.pi, unit="°"),
        },
        values=(0.0, 1.0),
        value_label="fraction scattered to the base, $P_s$",
        cost_label="operations a direction",
        against="theta_u",
        hemisphere=HemisphereHint(
            "theta_u",
            "phi",
            "The hemisphere of lights seen from above. The fibre leans to the right; the ring is "
            "the light.",
        ),
    ),
    topic="fuzz",
)
