"""Pictures of detail maps: the curves of the operators, and a photograph that is compensated."""

from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from shadefit.detail.closed_loop import closed_loop
from shadefit.detail.compensation import ComposedErrors, errors_between
from shadefit.detail.operators import OPERATORS
from shadefit.detail.photographs import painted, photograph
from shadefit.figures.picture import Picture
from shadefit.images.bc1 import blocks_of, decode_bc1, encode_bc1, packed

MATERIAL, PAINTING = "brick", "grime"
# The part of the photograph that is shown, so that its pixels can be seen
_SHOWN = slice(96, 192), slice(8, 104)
_GAIN = 16
# The histograms show errors up to this number of codes; the outer bars have the larger ones, too.
_LARGEST = 10
_DETAILS = np.linspace(0, 1, 11)
_TITLES = {
    "overlay": "overlay",
    "smooth-overlay": "smooth overlay, $f_{os}$",
    "symmetric-overlay": "symmetric overlay, $f_{oss}$",
}
# The methods that are compared: an operator, and whether its blocks are chosen in the closed loop
_METHODS = {
    "overlay": ("overlay", False),
    "$f_{os}$": ("smooth-overlay", False),
    "$f_{os}$, closed loop": ("smooth-overlay", True),
}


@dataclass(frozen=True)
class Composed:
    """The source of a method as it is decoded, what is seen of it, and the errors of that."""

    source: np.ndarray
    seen: np.ndarray
    codes: np.ndarray
    errors: ComposedErrors


def detail_pictures() -> dict[str, Picture]:
    """Return the pictures of detail maps, by name."""
    return {
        "detail-operators": Picture(
            "Operators of detail maps",
            "f(s, d) over the source s, for eleven details d. The curve of each detail "
            "passes through d at s = ½. There overlay has a corner for all d but ½, smooth overlay "
            "only for d > ½, and symmetric overlay none. The steeper a curve is, the more it "
            "enlarges the errors of the source.",
            draw_operators,
        ),
        "detail-photograph": Picture(
            "A detail map on a photograph",
            "A target that was painted on a photograph of bricks, and the detail and source that "
            "are stored in BC1. The three results are composed of the decoded detail and of "
            "sources that are compensated for it: for overlay and f_os by quicktex at its best "
            "level, and for f_os in the closed loop. Below them are their errors, multiplied by 16 "
            "about a mid grey (more than 7 codes are cut off), and the share of the values that "
            "have each error. The grey line is that of overlay. The images are a part of 96² "
            "pixels; the numbers and histograms are those of all 256² pixels, in codes of 8 bits.",
            draw_photograph,
            ("skimage.data", "quicktex.s3tc.bc1", "texture2ddecoder"),
        ),
    }


def draw_operators() -> Figure:
    """Draw the three operators over the source, for details from 0 to 1."""
    figure = Figure(figsize=(9.0, 3.2), layout="constrained")
    # The corner of overlay is a point of the curve.
    source = np.linspace(0, 1, 41)
    colours = colormaps["viridis"](np.linspace(0, 0.92, len(_DETAILS)))
    panels = figure.subplots(1, len(OPERATORS), sharex=True, sharey=True)
    for axes, operator in zip(panels, OPERATORS.values(), strict=True):
        axes.axvline(0.5, color="0.8", linewidth=0.8, zorder=0)
        for detail, colour in zip(_DETAILS, colours, strict=True):
            values = operator.blend(source, np.full_like(source, detail))
            axes.plot(
                source,
                values,
                color=colour,
                linewidth=1.3,
                clip_on=False,
                label=f"d = {detail:.1f}",
            )
        axes.set(xlabel="source s", box_aspect=1, xlim=(0, 1), ylim=(0, 1))
        axes.set_title(_TITLES[operator.name])
    panels[0].set_ylabel("f(s, d)")
    handles, labels = panels[0].get_legend_handles_labels()
    # From above to below, as the curves are.
    figure.legend(handles[::-1], labels[::-1], loc="outside right center")
    return figure


def composed() -> tuple[np.ndarray, np.ndarray, dict[str, Composed]]:
    """Return the target and the decoded detail (256, 256, 3), and the results of all methods."""
    material = photograph(MATERIAL)
    target = painted(material, PAINTING)
    height, width, _ = target.shape
    detail = decode_bc1(encode_bc1(material), height, width) / 255
    results = {}
    for label, (name, closed) in _METHODS.items():
        operator = OPERATORS[name]
        if closed:
            blocks = packed(*closed_loop(blocks_of(target), blocks_of(detail), operator))
        else:
            blocks = encode_bc1(operator.source(target, detail))
        source = decode_bc1(blocks, height, width) / 255
        seen = np.clip(operator.blend(source, detail), 0, 1)
        codes = np.floor(seen * 255 + 0.5) - np.round(target * 255)
        results[label] = Composed(source, seen, codes, errors_between(seen, target))
    return target, detail, results


def draw_photograph() -> Figure:
    """Draw a target, what is stored, what is composed by three methods, and the errors."""
    figure = Figure(figsize=(8.2, 6.6), layout="constrained")
    panels = figure.subplots(3, 1 + len(_METHODS))
    target, detail, results = composed()
    *_, last = results.values()
    stored = ("target", target), ("detail, BC1", detail), ("source of the closed loop", last.source)
    for axes, (title, pixels) in zip(panels[:, 0], stored, strict=True):
        _show(axes, pixels)
        axes.set_title(title)
    share = _shares(next(iter(results.values())).codes)
    for (seen, error, histogram), (label, result) in zip(
        panels[:, 1:].T, results.items(), strict=True
    ):
        _show(seen, result.seen)
        found = result.errors
        seen.set_title(f"{label}\nRMSE {found.rmse:.2f}, PSNR {found.psnr:.1f} dB")
        _show(error, np.clip(0.5 + _GAIN * result.codes / 255, 0, 1))
        error.set_title(f"error × {_GAIN}, largest {found.largest:.0f}")
        _histogram(histogram, result.codes, share)
    for axes in panels[2, 2:]:
        axes.set_yticklabels([])
    panels[2, 1].set_ylabel("share of the values")
    return figure


def _show(axes: Axes, pixels: np.ndarray) -> None:
    axes.imshow(np.round(pixels[_SHOWN] * 255).astype(np.uint8), interpolation="none")
    axes.set(xticks=[], yticks=[])
    axes.spines[:].set_visible(False)


def _shares(codes: np.ndarray) -> np.ndarray:
    """Return the share of errors with each code, −_LARGEST to _LARGEST; the ends have the rest."""
    counted = np.clip(codes, -_LARGEST, _LARGEST).astype(int) + _LARGEST
    return np.bincount(counted.ravel(), minlength=2 * _LARGEST + 1) / codes.size


def _histogram(axes: Axes, codes: np.ndarray, compared: np.ndarray) -> None:
    """Draw the shares of errors on a logarithmic axis, and those of another method as a line."""
    places = np.arange(-_LARGEST, _LARGEST + 1)
    axes.bar(places, _shares(codes), width=1, color="#0072b2")
    axes.stairs(compared, np.append(places, _LARGEST + 1) - 0.5, color="0.55", linewidth=1.2)
    axes.set(yscale="log", ylim=(1e-6, 1), xlabel="error in codes", box_aspect=1)
    axes.set_xticks([-10, -5, 0, 5, 10], ["≤ −10", "−5", "0", "5", "≥ 10"])
    axes.minorticks_off()
