"""`Problem` as a user declares it: axes, exact values, forms, published constants, shader names."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import jax

from fitting.form import Form, plain_form
from fitting.goal import Norm, Rounding, Side
from fitting.linearity import program_of
from fitting.shapes.chebyshev_sums import chebyshev
from fitting.shapes.exponential_sums import exponentials
from fitting.shapes.piecewise import piecewise_linear
from fitting.shapes.pole_sums import pole_sum
from fitting.shapes.rationals import polynomial, rational
from integrals.data import Data
from integrals.reference import Axis, Reference, restricted
from integrals.reference_of_source import EVERYTHING, make_reference, weighted
from integrals.sampling import Sampling
from integrals.sources import Source
from programs.printing.formula import definitions
from programs.program import reachable_values
from quantities.calling_convention import CallingConvention
from quantities.defaults import default_calling, default_exact_code
from quantities.plot_hints import PlotHints
from quantities.problem import Problem as Quantity
from quantities.problem import Published
from shadefit.result import Result, fit_result

# The names that tables may have
_NAME = r"[a-z0-9][a-z0-9._-]{0,63}"
# A form without a docstring gets its formula as the equation, if that is not longer than this.
_LONGEST = 1200


class Problem(Quantity):
    """A quantity of one's own: exact values over axes, and the forms that approximate it.

        p = Problem("tanhc", [Axis("x", 0, 4)], closed_form(jnp.tanh))

        @p.form(start=[1, 0.1, 0.4])
        def pade(x, a, b, c):
            return x * (a + b * x * x) / (1 + c * x * x)

        p.fit("pade", norm="linf")

    * `name`: letters, digits and dashes. `axes`: the arguments, with their domains.
    * `reference`: the exact values: a source or a sum of sources (`closed_form`, `quadrature`,
      `hemisphere`, `sphere`, `monte_carlo`), data (`table`, `samples`), or a `Reference`.
    * `symbol`, `definition`, `meaning`: texts for headers and pictures.
    * `codomain`: the interval of all exact values, which a `bounded` fit must keep to.
    * `weight`: a function of the axes. Errors are multiplied by it.
    * `published`: constants in print, to compare with.
    * `shader`: the name of the exported function; by default the name in capitals. `arguments`
      maps names of axes to those of the function's arguments. All are clamped to their domains.
    * `sampling`, `calling`, `plot`: for those who want to choose everything.

    The first form that is added is the one that `shadefit refit NAME` fits.
    """

    def __init__(
        self,
        name: str,
        axes: Sequence[Axis],
        reference: Source | Data | Sequence[Source] | Reference,
        *,
        symbol: str = "",
        definition: str = "",
        meaning: str = "",
        codomain: tuple[float | int, float | int] = EVERYTHING,
        weight: Callable[..., Any] | None = None,
        published: Sequence[Published] = (),
        shader: str = "",
        arguments: Mapping[str, str] | None = None,
        sampling: Sampling | None = None,
        calling: CallingConvention | None = None,
        plot: PlotHints | None = None,
    ):
        """Raise ValueError for a source that does not fit the axes, and for names of no axis."""
        if not re.fullmatch(_NAME, name):
            raise ValueError(f"name {name!r}: allowed are up to 64 of a-z, 0-9, '-', '_' and '.'")
        closed = reference.function if isinstance(reference, Source) else None
        if not isinstance(reference, Reference):
            reference = make_reference(
                reference,
                name=name,
                axes=axes,
                symbol=symbol,
                meaning=meaning,
                definition=definition,
                sampling=sampling,
                codomain=codomain,
            )
        if weight is not None:
            reference = weighted(reference, weight)
        if calling is None:
            calling = default_calling(name, axes, reference.symbol, shader, arguments)
        exact = default_exact_code(calling, closed, reference.axes)
        super().__init__(
            reference,
            [],
            calling,
            published=tuple(published),
            closed_form=None if exact is None else closed,
            exact_code=exact,
            plot=plot,
        )

    def form(
        self,
        function: Callable[..., Any] | None = None,
        *,
        start: Sequence[float | int] = (),
        name: str | None = None,
        domain: Mapping[str, tuple[float | int, float | int]] | None = None,
        sizes: Mapping[str, int] | None = None,
    ) -> Callable[..., Any]:
        """Add a plain function as a form; also a decorator. Returns the function.

        Arguments named like axes are axes, the rest are coefficients. The first line of the
        docstring is the equation. `start` has a value for each coefficient; a quotient of linear
        functions of its coefficients needs none. `name` is by default the function's. `domain`
        restricts axes, by name. `sizes` has the lengths of arguments that are arrays of
        coefficients. Raises ValueError for a function that cannot be traced.
        """
        if function is None:
            return partial(self.form, start=start, name=name, domain=domain, sizes=sizes)
        axes = restricted(self.axes, **domain) if domain else None
        self.add(plain_form(function, self.reference, start, name, axes, sizes))
        return function

    def rational(
        self,
        numerator: Sequence,
        denominator: Sequence,
        *,
        name: str = "rational",
        domain: Mapping[str, tuple[float | int, float | int]] | None = None,
        of: Callable[..., Any] | None = None,
        times: Callable[..., Any] | None = None,
        plus: Callable[..., Any] | None = None,
        one: int | tuple[int, ...] | None = None,
    ) -> Form:
        """Add plus + times · N/D, a quotient of sums of monomials, and return the form.

        `numerator` and `denominator` are exponents, see `powers`; `of` has the variables, by
        default the axes; `one` is the exponent in D whose coefficient is 1. See
        `fitting.shapes.rationals.rational` for the rest.
        """
        structure = {"of": of, "times": times, "plus": plus, "one": one}
        return self._shaped(rational, numerator, denominator, name=name, domain=domain, **structure)

    def polynomial(
        self,
        exponents: int | Sequence,
        *,
        name: str = "polynomial",
        domain: Mapping[str, tuple[float | int, float | int]] | None = None,
        of: Callable[..., Any] | None = None,
        times: Callable[..., Any] | None = None,
        plus: Callable[..., Any] | None = None,
    ) -> Form:
        """Add plus + times · Σ cᵢ zⁱ and return it; `exponents` may be the total degree."""
        structure = {"of": of, "times": times, "plus": plus}
        return self._shaped(polynomial, exponents, name=name, domain=domain, **structure)

    def chebyshev(
        self,
        degrees: int | Sequence[int],
        *,
        name: str = "chebyshev",
        domain: Mapping[str, tuple[float | int, float | int]] | None = None,
    ) -> Form:
        """Add a sum of Chebyshev polynomials, of a degree for each axis, and return it."""
        return self._shaped(chebyshev, degrees, name=name, domain=domain)

    def exponentials(
        self,
        terms: int,
        *,
        name: str = "exponentials",
        domain: Mapping[str, tuple[float | int, float | int]] | None = None,
        constant: bool = False,
        along: str = "",
        degree: int = 0,
    ) -> Form:
        """Add Σ aₖ exp(−bₖ x), with a constant if wanted, and return it.

        x is the axis called `along`, by default the first. The coefficients are polynomials of a
        total `degree` in the other axes.
        """
        own = {"constant": constant, "along": along, "degree": degree}
        return self._shaped(exponentials, terms, name=name, domain=domain, **own)

    def pole_sum(
        self,
        poles: int,
        degree: int,
        *,
        name: str = "poles",
        domain: Mapping[str, tuple[float | int, float | int]] | None = None,
        of: Callable[..., Any] | None = None,
    ) -> Form:
        """Add a polynomial of a degree plus Σ aₖ/(bₖ + x), and return it; for one variable."""
        return self._shaped(pole_sum, poles, degree, name=name, domain=domain, of=of)

    def piecewise_linear(
        self,
        knots: int | Sequence,
        *,
        name: str = "piecewise",
        domain: Mapping[str, tuple[float | int, float | int]] | None = None,
    ) -> Form:
        """Add lines between values at knots, a number of them or a list, and return the form.

        With several axes the knots are those of a grid: a number for all, or a sequence with a
        number or a list for each.
        """
        return self._shaped(piecewise_linear, knots, name=name, domain=domain)

    def _shaped(
        self,
        make: Callable[..., Form],
        *given: Any,
        name: str,
        domain: Mapping[str, tuple[float | int, float | int]] | None,
        **structure: Any,
    ) -> Form:
        axes = restricted(self.axes, **domain) if domain else None
        with jax.enable_x64(True):
            return self.add(make(self.reference, *given, name=name, axes=axes, **structure))

    def add(self, form: Form) -> Form:
        """Add a form and return it. Raises ValueError if another one has its name."""
        if form.name in self.single_forms:
            raise ValueError(f"{self.name} has a form {form.name!r}: allowed is another name")
        with jax.enable_x64(True):
            program = program_of(form)  # Raises ValueError if the form cannot be exported.
        for k in sorted({*range(form.size)} - reachable_values(program)):
            raise ValueError(
                f"{form.name} does not use its coefficient {form.coefficient_names[k]}: allowed "
                "are coefficients that its value depends on"
            )
        if form.equation == form.name:
            names = [*map(str, form.coefficient_names), *(axis.symbol for axis in form.axes)]
            text = definitions(program, names, self.symbol)
            form = replace(form, equation=text if len(text) <= _LONGEST else form.name)
        self.forms = [*self.forms, form]
        return form

    def fit(
        self,
        form: str | None = None,
        *,
        norm: Norm = "l2",
        relative: bool = False,
        side: Side = "both",
        rounding: Rounding = "none",
        bounded: bool = False,
    ) -> Result:
        """Fit a form, by default the first one, and return the result, which shows itself.

        * `norm`: 'l2' minimises the sum of squared errors, 'linf' the largest error.
        * `relative`: errors are divided by the exact value.
        * `side`: 'below' or 'above' allows errors on one side only; with 'linf'.
        * `rounding`: 'float32' or 'float16' rounds the coefficients.
        * `bounded`: all values are in the codomain, and proven to be; with 'linf'.

        Raises ValueError for a form that is not known, and for a fit that is refused, such as one
        with a pole.
        """
        goal = {
            "norm": norm,
            "relative": relative,
            "side": side,
            "rounding": rounding,
            "bounded": bounded,
        }
        return fit_result(self, self.default if form is None else self.find_form(form), goal)
