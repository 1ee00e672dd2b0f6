"""shadefit: exact shading integrals, certified curve fits, and shader code that has been run.

A program needs no other import than `import shadefit`. The names below are imported when they are
first used, so that the import itself does not wait for JAX. Turn float64 on before anything is
evaluated: `jax.config.update("jax_enable_x64", True)`.

* Your own quantity: `Problem(name, axes, reference)` with each `Axis`. The reference is a
  `closed_form`, a `quadrature`, `hemisphere` or `sphere` integral, or `monte_carlo` samples, each
  with a stated error; or data, from a `table` in a file or `samples` in arrays. `Published` has
  constants in print, `powers` the exponents of a polynomial. `Problem.fit` returns a `Result`.
  `fit_with_shared_denominator` fits several quantities together.
* Exact values: `PS`, `G`, `Q`, `R` and `VELVET` are the references of the fuzz BRDF.
  `make_reference` makes a `Reference` without a quantity. `Sampling`, `Estimate` and `leg` are for
  a reference that is written out in full.
* Many points: `values(of, points)` are those of a quantity, a reference or a fitted form, and
  `estimates` the exact ones with their errors. Both need little memory, however many points.
* Fits: `fit` finds the coefficients of a `Form` for a `Goal`, and returns a `Fit`. `plain_form`
  makes a form of a plain function.
* Quantities: `problem(name)`, `problems()` and `register(problem)`. `CallingConvention`,
  `Argument`, `PlotHints` and `AxisHint` say how one is called and drawn.
* Distributions of microfacet normals: `fit_ndf` fits a piecewise-linear one to an `analytic_ndf` or
  a `measured_ndf`, and returns an `NdfFit`. `fit_blend` fits a blend of two to an anisotropic
  `named_ndf`, and returns a `BlendFit`.
* Tables: `load(name)` returns the fitted form of a table, `resolve(name)` an `Entry` with the table
  and its quantity. `table_of(fit, command)` makes a `Table` of a fit.
* Code: `source_file` returns the shader code of an entry, and `exported_values` what it computes.
  `write_source` returns the code of any `function` with `Parameter`s, in one of the `LANGUAGES`.
"""

from typing import TYPE_CHECKING

from programs.public_names import import_when_used

if TYPE_CHECKING:
    from coefficients.catalogue import Entry as Entry
    from coefficients.catalogue import load as load
    from coefficients.catalogue import resolve as resolve
    from coefficients.exported_code import exported_values as exported_values
    from coefficients.exported_code import source_file as source_file
    from coefficients.record import table_of as table_of
    from coefficients.table import Table as Table
    from fitting import Fit as Fit
    from fitting import FittedForm as FittedForm
    from fitting import Form as Form
    from fitting import Goal as Goal
    from fitting import Stage as Stage
    from fitting import plain_form as plain_form
    from fitting.fit import fit as fit
    from fitting.shapes.monomial_sums import powers as powers
    from integrals import PS as PS
    from integrals import VELVET as VELVET
    from integrals import Axis as Axis
    from integrals import Estimate as Estimate
    from integrals import G as G
    from integrals import Q as Q
    from integrals import R as R
    from integrals import Reference as Reference
    from integrals import Sampling as Sampling
    from integrals.data import samples as samples
    from integrals.data import table as table
    from integrals.reference import leg as leg
    from integrals.reference_of_source import make_reference as make_reference
    from integrals.sources import closed_form as closed_form
    from integrals.sources import hemisphere as hemisphere
    from integrals.sources import monte_carlo as monte_carlo
    from integrals.sources import quadrature as quadrature
    from integrals.sources import sphere as sphere
    from programs import LANGUAGES as LANGUAGES
    from programs import Parameter as Parameter
    from programs import function as function
    from programs import write_source as write_source
    from quantities import problem as problem
    from quantities import problems as problems
    from quantities import register as register
    from quantities.calling_convention import Argument as Argument
    from quantities.calling_convention import CallingConvention as CallingConvention
    from quantities.piecewise.blend_fit import BlendFit as BlendFit
    from quantities.piecewise.blend_fit import fit_blend as fit_blend
    from quantities.piecewise.fit import NdfFit as NdfFit
    from quantities.piecewise.fit import fit_ndf as fit_ndf
    from quantities.piecewise.targets import analytic_ndf as analytic_ndf
    from quantities.piecewise.targets import measured_ndf as measured_ndf
    from quantities.piecewise.targets import named_ndf as named_ndf
    from quantities.plot_hints import AxisHint as AxisHint
    from quantities.plot_hints import PlotHints as PlotHints
    from quantities.problem import Published as Published
    from shadefit.declaration import Problem as Problem
    from shadefit.many_points import estimates as estimates
    from shadefit.many_points import values as values
    from shadefit.result import Result as Result
    from shadefit.shared_denominator import (
        fit_with_shared_denominator as fit_with_shared_denominator,
    )

__getattr__, __dir__, __all__ = import_when_used(
    __name__,
    {
        "coefficients.catalogue": ("Entry", "load", "resolve"),
        "coefficients.exported_code": ("exported_values", "source_file"),
        "coefficients.record": ("table_of",),
        "coefficients.table": ("Table",),
        "fitting": ("Fit", "FittedForm", "Form", "Goal", "Stage", "plain_form"),
        "fitting.fit": ("fit",),
        "fitting.shapes.monomial_sums": ("powers",),
        "integrals": (
            *("PS", "G", "Q", "R", "VELVET"),
            *("Axis", "Estimate", "Reference", "Sampling"),
        ),
        "integrals.data": ("samples", "table"),
        "integrals.reference": ("leg",),
        "integrals.reference_of_source": ("make_reference",),
        "integrals.sources": (
            *("closed_form", "hemisphere", "monte_carlo", "quadrature", "sphere"),
        ),
        "programs": ("LANGUAGES", "Parameter", "function", "write_source"),
        "quantities": ("problem", "problems", "register"),
        "quantities.calling_convention": ("Argument", "CallingConvention"),
        "quantities.piecewise.blend_fit": ("BlendFit", "fit_blend"),
        "quantities.piecewise.fit": ("NdfFit", "fit_ndf"),
        "quantities.piecewise.targets": ("analytic_ndf", "measured_ndf", "named_ndf"),
        "quantities.plot_hints": ("AxisHint", "PlotHints"),
        "quantities.problem": ("Published",),
        "shadefit.declaration": ("Problem",),
        "shadefit.many_points": ("estimates", "values"),
        "shadefit.result": ("Result",),
        "shadefit.shared_denominator": ("fit_with_shared_denominator",),
    },
)
