"""What `--json` prints of the fuzz BRDF: errors of the ambient models, and of rendered images."""

from shadefit.records import Count, Number, Part, Place, Size


class AmbientErrors(Part):
    """Errors of the ambient model relative to the mean radiance: rms and bias by functions."""

    part: str
    light: str
    mean: Number
    rms: dict[str, Size]
    bias: dict[str, Number]
    worst: Number
    where: Place


class AmbientModelErrors(Part):
    """A model of the layer with some P_s and G: errors by light relative to the mean radiance.

    `scattered` and `scattering` name P_s and G. `brightest` is the largest radiance in uniform
    light of radiance one, `least` the least one in any light. `operations` are those of the
    exported function by its parts.
    """

    model: str
    meaning: str
    scattered: str
    scattering: str
    rms: dict[str, Size]
    largest: dict[str, Size]
    brightest: Number
    least: Number
    operations: dict[str, Count]


class LargestRadiance(Part):
    """The largest radiance in uniform light of radiance one, and where it is."""

    what: str
    largest: Number
    where: Place


class ImageRecord(Part):
    """An image's mean luminance, and its rms and largest difference from the exact image."""

    scene: str
    tables: str
    mean: Number
    rms: Size
    max: Size
