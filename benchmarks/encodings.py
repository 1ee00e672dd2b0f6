"""Measure the encodings of anisotropic roughness: `python benchmarks/encodings.py [--json]`.

It prints the errors of quantised texels and the worst that a search finds, those of half precision,
of compressed synthetic maps and normals, and of the mixtures of the talk's slide on limitations.
All errors of maps are total variations between the GGX lobe that is encoded and the decoded one.
"""

import argparse
import json

import jax
import numpy as np

from programs import evaluate, trace
from quantities.maps import DECODERS
from shadefit.images.block_compression import decode_blocks, encode_blocks
from shadefit.maps.aniso_map import encode_level, mip_entries
from shadefit.maps.encoding_errors import (
    errors_at,
    errors_of,
    least_eigenvalue_between,
    mixed_error,
    mixture_distance,
    random_points,
    worst_texel,
)
from shading.maps.encode import encode, entries_of_widths
from shading.maps.encodings import ENCODINGS

SIZE = 256
# (αt, αb) of the talk's slide
LIMITS = ((0.29, 0.04), (0.87, 0.04), (0.87, 0.1))


def synthetic_maps() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return the matrices (256, 256, 3) and the normals (256, 256, 3) of four materials."""
    rng = np.random.default_rng(11)
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE
    noise = rng.normal(size=(SIZE, SIZE))
    # Brushed metal: streaks along x, whose direction varies by 2.5 degrees
    streaks = np.cumsum(noise, axis=1) / np.sqrt(np.arange(1, SIZE + 1))
    brushed = _map(0.35 + 0.04 * streaks, 0.08 + 0.01 * streaks, np.radians(2.5) * noise)
    # Twill: threads in two directions, with the slopes of round threads
    thread = ((x + y) * 16 % 1 < 0.5).astype(float)
    turn = np.where(thread > 0, np.pi / 4, -np.pi / 4)
    across = np.sin(2 * np.pi * 32 * (x + y))
    twill = _map(np.full_like(x, 0.45), np.full_like(x, 0.15), turn, 0.35 * across, 0.35 * across)
    # Foil: facets around random points, each with a slope and a direction of its own
    centres, slopes = rng.random((200, 2)), rng.normal(size=(200, 2)) * 0.3
    distance = (x[..., None] - centres[:, 0]) ** 2 + (y[..., None] - centres[:, 1]) ** 2
    nearest = distance.argmin(axis=-1)
    angles = rng.uniform(-np.pi / 2, np.pi / 2, 200)[nearest]
    tilt = np.moveaxis(slopes[nearest], -1, 0)
    foil = _map(np.full_like(x, 0.2), np.full_like(x, 0.06), angles, *tilt)
    # Spun metal: circles around the centre
    spun = _map(np.full_like(x, 0.4), np.full_like(x, 0.06), np.arctan2(x - 0.5, 0.5 - y))
    return {"brushed": brushed, "twill": twill, "foil": foil, "spun": spun}


def _map(along, across, theta, slope_x=0.0, slope_y=0.0) -> tuple[np.ndarray, np.ndarray]:
    widths = (np.clip(each, 0.03, 1.0) for each in (along, across))
    normals = np.stack(np.broadcast_arrays(slope_x, slope_y, np.ones_like(theta)), axis=-1)
    return (
        entries_of_widths(*widths, theta),
        normals / np.linalg.norm(normals, axis=-1, keepdims=True),
    )


def normal_errors(normals: np.ndarray) -> dict[str, float]:
    """Return the angles in degrees between normals and what 8 bits and BC5 leave of them."""
    codes = np.rint((normals[..., :2] / 2 + 0.5) * 255).astype(np.uint8)
    height, width, _ = codes.shape
    read = decode_blocks("bc5", encode_blocks("bc5", codes), width, height)
    found = {}
    for name, texels in (("8 bits", codes), ("bc5", read)):
        xy = texels / 255 * 2 - 1
        z = np.sqrt(np.maximum(1 - np.square(xy).sum(-1), 0))
        decoded = np.concatenate([xy, z[..., None]], axis=-1)
        crossed = np.linalg.norm(np.cross(normals, decoded), axis=-1)
        angle = np.degrees(np.arctan2(crossed, (normals * decoded).sum(-1)))
        found |= {f"{name}, mean": angle.mean(), f"{name}, 99 %": np.quantile(angle, 0.99)}
    return {key: float(value) for key, value in found.items()}


def quantised() -> dict:
    points = random_points(40_000)
    rows = {}
    for name in ENCODINGS:
        for bits in (8, 10):
            errors, worst = errors_of(name, points, bits), worst_texel(name, bits)
            rows[f"{name}, {bits} bits"] = {
                "mean": errors.mean,
                "99 %": errors.percentile,
                "largest": errors.largest,
                "αt > 8αb: 99 %": errors.elongated,
                "search": worst.error,
                "at αt": worst.alpha_t,
                "αb": worst.alpha_b,
                "θ": worst.theta,
            }
    return rows


def half_precision() -> dict:
    points = random_points(40_000)
    alpha_t, alpha_b = np.exp(points[:, 0]), np.exp(points[:, 1])
    rows = {}
    for name in ENCODINGS:
        texels = encode(name, alpha_t, alpha_b, points[:, 2])
        code = DECODERS[f"aniso-{name}"].exact_code
        for precision, dtype in (("float", np.float32), ("half", np.float16)):
            (function,) = code.functions(precision)
            found = evaluate(trace(function), texels, dtype).astype(float)[:, 1]
            error = np.abs(found / alpha_b - 1)
            rows[f"{name}, {precision}"] = {
                "αb: 99 %": float(np.quantile(error, 0.99)),
                "αb: largest": float(error.max()),
            }
    return rows


def compressed() -> dict:
    rows = {}
    for material, (entries, _) in synthetic_maps().items():
        levels = mip_entries(entries)
        for level in (0, 2):
            for format in ("rgba8", "bc7", "bc1"):
                row = {}
                for name in ENCODINGS:
                    found = encode_level(levels[level], name, format)
                    row |= {f"{name}, mean": found.mean, f"{name}, 99 %": found.percentile}
                rows[f"{material} mip {level}, {format}"] = row
    return rows


def limitations() -> dict:
    rows = {}
    angles = np.linspace(-np.pi / 2, np.pi / 2, 181)
    for alpha_t, alpha_b in LIMITS:
        logs = np.broadcast_to(np.log([alpha_t, alpha_b]), (181, 2))
        points = np.column_stack([logs, angles])
        pairs = [
            entries_of_widths(
                np.full(2, alpha_t), np.full(2, alpha_b), t + np.array([0, np.pi / 18])
            )
            for t in angles[::5]
        ]
        for name in ENCODINGS:
            mixed = [mixed_error(name, *pair) for pair in pairs]
            rows[f"{alpha_t}, {alpha_b}, {name}"] = {
                "8 bits, largest": float(errors_at(name, points, 8).max()),
                "10° apart, least": min(mixed),
                "10° apart, largest": max(mixed),
            }
        first, second = pairs[0]
        found = mixture_distance(first, second, (first + second) / 2)
        rows[f"{alpha_t}, {alpha_b}, mean of S"] = {"10° apart, largest": found}
    return rows


def eigenvalues() -> dict:
    rows = {}
    for name, stores in (("correlation, as published", False), ("Sxy itself", True)):
        least, fraction = least_eigenvalue_between(10**6, stores)
        rows[name] = {"least eigenvalue": least, "fraction negative": fraction}
    return rows


def show(title: str, rows: dict[str, dict[str, float]]) -> None:
    print(f"\n{title}")
    names = list(next(iter(rows.values())))
    first = max(map(len, rows))
    widths = [max(len(each), 9) for each in names]
    print(" " * first, *(f"{each:>{w}}" for each, w in zip(names, widths, strict=True)), sep="  ")
    for name, row in rows.items():
        cells = [
            f"{row[k]:>{w}.3g}" if k in row else " " * w for k, w in zip(names, widths, strict=True)
        ]
        print(f"{name:<{first}}", *cells, sep="  ")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print one JSON object instead")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    found = {
        "Total variation of quantised texels, 40,000 random and searched for": quantised(),
        "Relative error of the decoded αb by the precision of the shader": half_precision(),
        "Eigenvalues of a million filtered texels": eigenvalues(),
        "Total variation of compressed maps": compressed(),
        "Angle of normals, degrees": {
            name: normal_errors(normals) for name, (_, normals) in synthetic_maps().items()
        },
        "Combinations of widths on the talk's slide": limitations(),
    }
    if options.json:
        print(json.dumps(found, indent=2, ensure_ascii=False))
        return
    for title, rows in found.items():
        show(title, rows)


if __name__ == "__main__":
    main()
