"""`shadefit render`: a scene with exact functions and with tables, side by side, as PNG and EXR."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coefficients.files import require_writable, write_whole_bytes
from integrals import PS, Axis
from shadefit.options import checked
from shadefit.render.fibers import azimuths
from shadefit.render.functions import table_sets
from shadefit.render.images import colour, write_exr
from shadefit.render.scenes import SCENES
from shadefit.render.shade import Light, Material, render
from shadefit.render.sheet import compare_sheet
from shadefit.terminal import print_json, print_table, stages

# Samples a pixel, an axis.
SAMPLES = 2
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
_OPTIONS = (
    Axis("density", "d", "1", 0.0, 0.5, "density of the layer"),
    Axis("spread", "", "1", 0.0, 1.0, "spread of the lobe", open_below=True),
    Axis("tilt", "θf", "rad", 0.0, PS.axes[1].upper, "polar angle of the fibres"),
    Axis("sun_height", "", "rad", 0.0, np.pi / 2, "height of the sun above the horizon"),
    Axis("sun_azimuth", "", "rad", -2 * np.pi, 2 * np.pi, "the sun's azimuth from the right"),
    Axis("sun", "", "1", 0.0, 1e3, "irradiance of the sun"),
    Axis("sky", "", "1", 0.0, 1e3, "radiance of the sky"),
    Axis("size", "", "1", 16.0, 1024.0, "pixels an edge"),
)


@dataclass(frozen=True)
class Settings:
    """What the command line says: angles in radians, colours as #rrggbb."""

    density: float = 0.2
    spread: float = 0.2
    tilt: float = float(np.radians(23))
    fiber: str = "#ff6f9c"
    base: str = "#7a0f2b"
    sun: float = 7.0
    sun_height: float = float(np.radians(40))
    sun_azimuth: float = float(np.radians(215))
    sky: float = 1.2
    fibers: str = "crushed"
    size: int = 256

    @property
    def material(self) -> Material:
        """The layer and its base. Raises ValueError for a colour that is none."""
        fiber, base = colour(self.fiber, "fiber"), colour(self.base, "base")
        return Material(self.density, self.spread, self.tilt, fiber, base)

    @property
    def light(self) -> Light:
        """Sun and sky; azimuth 0 is to the right, 90° away from the camera."""
        flat = np.cos(self.sun_height)
        x, y = flat * np.cos(self.sun_azimuth), flat * np.sin(self.sun_azimuth)
        return Light((float(x), float(y), float(np.sin(self.sun_height))), self.sun, self.sky)

    def check(self) -> None:
        """Raise ValueError for the first value that is outside its domain."""
        for axis in _OPTIONS:
            checked(axis, float(getattr(self, axis.name)))


@dataclass(frozen=True)
class Comparison:
    """A scene's linear image with exact functions (h, w, 3), and with each set of tables."""

    scene: str
    exact: np.ndarray
    tables: dict[str, np.ndarray]

    def difference(self, name: str) -> np.ndarray:
        """Give the difference of luminance (h, w) between a table's image and the exact one."""
        return (self.tables[name] - self.exact) @ _LUMINANCE


def run(scenes: list[str], settings: Settings, out: Path, sweep: bool, as_json: bool) -> None:
    """Render, compare and write `render.png` and `render.exr`, or `sweep.png` alone."""
    settings.check()
    unknown = [name for name in scenes if name not in SCENES]
    if unknown:
        raise ValueError(f"scene is {unknown[0]!r}; allowed: {', '.join(SCENES)}")
    _ = settings.material, settings.light
    require_writable(out)
    if sweep:
        from shadefit.render.sweep import draw_sweep  # noqa: PLC0415

        path = out / "sweep.png"
        if len(scenes) > 1:
            raise ValueError(f"scenes are {', '.join(scenes)}; allowed with --sweep: one")
        write_whole_bytes(path, draw_sweep(scenes[0] if scenes else "cloth", settings))
        if as_json:
            print_json({"files": [str(path)]})
        else:
            print(path)
        return
    with stages() as progress:
        task = progress.add_task("")
        comparisons = []
        for name in scenes or list(SCENES):
            progress.update(task, description=name)
            comparisons.append(compare(name, settings))
    write_whole_bytes(out / "render.png", compare_sheet(comparisons))
    write_whole_bytes(out / "render.exr", write_exr(_channels(comparisons)))
    record = [_record(c, name) for c in comparisons for name in c.tables]
    if as_json:
        print_json({"files": [str(out / f"render.{x}") for x in ("png", "exr")], "images": record})
        return
    print_table(
        "Luminance against the image with exact functions",
        ["scene", "tables", "mean luminance", "rms difference", "largest"],
        [
            [r["scene"], r["tables"], *(f"{r[key]:.2e}" for key in ("mean", "rms", "max"))]
            for r in record
        ],
        f"{out / 'render.png'}, and linear in {out / 'render.exr'}.",
    )


def compare(scene: str, settings: Settings) -> Comparison:
    """Render a scene with exact functions and with every set of tables that is there."""
    names = ("exact", *table_sets())
    SCENES[scene].hits(settings.size * SAMPLES)
    # Compilation holds one core at a time: a second image fills the other.
    with ThreadPoolExecutor(2) as workers:
        images = dict(
            zip(names, workers.map(lambda name: image(scene, settings, name), names), strict=True)
        )
    return Comparison(scene, images.pop("exact"), images)


def image(scene: str, settings: Settings, name: str) -> np.ndarray:
    """Render one linear image (size, size, 3), averaged over the samples of each pixel."""
    hits = SCENES[scene].hits(settings.size * SAMPLES)
    turns = azimuths(settings.fibers, hits)
    flat = render(SCENES[scene], hits, settings.material, settings.light, name, turns)
    return flat.reshape(settings.size, SAMPLES, settings.size, SAMPLES, 3).mean(axis=(1, 3))


def _channels(comparisons: list[Comparison]) -> dict[str, np.ndarray]:
    """Name the images' channels: R, G, B of the first exact one, then scene.table.R and so on."""
    layers = {
        f"{c.scene}.{name}.": pixels
        for c in comparisons
        for name, pixels in (("exact", c.exact), *c.tables.items())
    }
    layers[""] = comparisons[0].exact
    return {
        f"{layer}{channel}": pixels[..., i]
        for layer, pixels in layers.items()
        for i, channel in enumerate("RGB")
    }


def _record(comparison: Comparison, name: str) -> dict:
    difference = comparison.difference(name)
    return {
        "scene": comparison.scene,
        "tables": name,
        "mean": float(np.mean(comparison.exact @ _LUMINANCE)),
        "rms": float(np.sqrt(np.mean(difference**2))),
        "max": float(np.abs(difference).max()),
    }
