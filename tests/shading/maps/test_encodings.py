"""Encodings of anisotropic roughness: round trips, isotropy, derivatives, distances."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from shading.maps.encode import encode, entries_of_widths, widths_of_entries
from shading.maps.encodings import ENCODINGS, decode_entries, decode_widths
from shading.maps.total_variation import total_variation


def some_widths(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    alphas = np.exp(rng.uniform(np.log(0.03), 0.0, (count, 2)))
    return alphas.max(1), alphas.min(1), rng.uniform(-np.pi / 2, np.pi / 2, count)


def decoded(name: str, texels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    widths = jax.vmap(lambda texel: jnp.stack(decode_widths(name, *texel)))(texels)
    entries = jax.vmap(lambda texel: jnp.stack(decode_entries(name, *texel)))(texels)
    return np.asarray(widths), np.asarray(entries)


@pytest.mark.parametrize("name", ENCODINGS)
def test_decoders_invert_the_encoder(name):
    alpha_t, alpha_b, theta = some_widths(500)
    # Nearer to isotropy, the widths are taken as equal.
    apart = alpha_t > 1.01 * alpha_b
    alpha_t, alpha_b, theta = alpha_t[apart], alpha_b[apart], theta[apart]
    texels = encode(name, alpha_t, alpha_b, theta)
    assert texels.min() >= 0 and texels.max() <= 1
    widths, entries = decoded(name, texels)
    np.testing.assert_allclose(widths[:, 0], alpha_t, rtol=1e-12)
    np.testing.assert_allclose(widths[:, 1], alpha_b, rtol=1e-11)
    np.testing.assert_allclose(widths[:, 2], np.cos(theta), atol=1e-11)
    np.testing.assert_allclose(widths[:, 3], np.sin(theta), atol=1e-11)
    np.testing.assert_allclose(entries[:, :3], entries_of_widths(alpha_t, alpha_b, theta), 1e-10)
    np.testing.assert_allclose(entries[:, 3], alpha_t * alpha_b, rtol=1e-11)


@pytest.mark.parametrize("name", ENCODINGS)
def test_the_tangent_is_a_unit_vector_at_isotropy_and_at_signed_zeros(name):
    """The published decoder has (0, 0) or half of a unit vector there, if sign(0) is 0."""
    centre = 0.5 if name in ("published", "stereographic") else 128 / 255
    third = 0.4 if name in ("published", "stereographic") else centre
    second = np.nextafter(centre, [0, centre, 1])
    texels = np.array([[0.4, each, third] for each in second] + [[0.0, centre, -0.0]])
    # Wider across than along, with a correlation of exactly zero: the tangent is (0, ±1).
    texels = np.concatenate([texels, encode(name, np.array([0.1]), np.array([0.5]), np.zeros(1))])
    widths, _ = decoded(name, texels)
    np.testing.assert_allclose(np.hypot(widths[:, 2], widths[:, 3]), 1, atol=1e-14)
    np.testing.assert_allclose(widths[-1], [0.5, 0.1, 0, 1], atol=1e-12)
    np.testing.assert_allclose(widths[:3, 0], widths[:3, 1], rtol=1e-9)


@pytest.mark.parametrize("name", ENCODINGS)
@pytest.mark.slow
def test_derivatives_are_finite_at_any_texel(name):
    numbers = [-0.0, 0.3, 0.5, 128 / 255, 1.0]
    texels = np.array([[x, y, z] for x in numbers for y in numbers for z in numbers])

    def both(texel):
        return jnp.stack([*decode_widths(name, *texel), *decode_entries(name, *texel)])

    assert np.isfinite(np.asarray(jax.vmap(jax.jacfwd(both))(texels))).all()


def test_widths_come_back_from_the_matrix():
    alpha_t, alpha_b, theta = some_widths(500)
    found = widths_of_entries(entries_of_widths(alpha_t, alpha_b, theta))
    np.testing.assert_allclose(found[0], alpha_t, rtol=1e-12)
    np.testing.assert_allclose(found[1], alpha_b, rtol=1e-9)
    # Exchanged widths with the direction across are the same matrix.
    crossed = entries_of_widths(alpha_b, alpha_t, theta + np.pi / 2)
    np.testing.assert_allclose(crossed, entries_of_widths(alpha_t, alpha_b, theta), atol=1e-15)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("other", 0.5, 0.5, 0.0), "no encoding is called 'other': allowed are published, "),
        (("published", 0.0, 0.5, 0.0), r"αt = 0: allowed are numbers in \(0, 1\]"),
        (("published", 0.5, np.nan, 0.0), r"αb = nan: allowed are numbers in \(0, 1\]"),
        (("published", 0.5, 1.5, 0.0), r"αb = 1.5: allowed are numbers in \(0, 1\]"),
        (("published", 0.5, 0.5, np.inf), "an angle of the tangent is not finite"),
    ],
)
def test_what_cannot_be_encoded_is_refused(given, message):
    name, *numbers = given
    with pytest.raises(ValueError, match=message):
        encode(name, *(np.array([each]) for each in numbers))


def test_no_decoder_has_an_unknown_name():
    with pytest.raises(ValueError, match="no encoding is called '': allowed are published"):
        decode_widths("", 0.5, 0.5, 0.5)


def by_quadrature(first: np.ndarray, second: np.ndarray, size: int = 600) -> float:
    """Return ½∫|p − q| over slopes, at nodes of equal mass in the lobe of the mean matrix."""
    mean = (first + second) / 2
    angle, share = ((np.arange(size) + 0.5) / size for _ in range(2))
    radius = np.sqrt(share / (1 - share))[:, None]
    circle = np.stack([np.cos(2 * np.pi * angle), np.sin(2 * np.pi * angle)])
    matrix = np.array([[mean[0], mean[1]], [mean[1], mean[2]]])
    slopes = np.einsum("ij,jrk->irk", np.linalg.cholesky(matrix), radius * circle[:, None])

    def density(entries):
        inverse = np.linalg.inv([[entries[0], entries[1]], [entries[1], entries[2]]])
        square = np.einsum("irk,ij,jrk->rk", slopes, inverse, slopes)
        return np.sqrt(np.linalg.det(inverse)) / (np.pi * (1 + square) ** 2)

    return float(np.mean(np.abs(density(first) - density(second)) / density(mean)) / 2)


def test_the_total_variation_is_that_of_quadrature():
    alpha_t, alpha_b, theta = some_widths(24)
    entries = entries_of_widths(alpha_t, alpha_b, theta)
    first, second = entries[:12], entries[12:]
    found = total_variation(first, second)
    expected = [by_quadrature(*pair) for pair in zip(first, second, strict=True)]
    # The quadrature has kinks where the densities are equal.
    np.testing.assert_allclose(found, expected, atol=3e-4)
    np.testing.assert_allclose(total_variation(second, first), found, atol=1e-13)


def test_the_total_variation_is_known_in_simple_cases():
    # Isotropic lobes of widths ratio D: the masses within the radius where they are equal.
    one, half = np.array([1.0, 0, 1.0]), np.array([0.25, 0, 0.25])
    assert total_variation(one, half) == pytest.approx(1 / 3, abs=1e-14)
    assert total_variation(one, one) == pytest.approx(0, abs=1e-7)
    # Equal determinants: only the angle decides. 2/π (arctan x − arctan(x a/b)) at x = √(b/a) = 2
    turned = total_variation(np.array([1.0, 0, 0.25]), np.array([0.5, 0, 0.5]))
    assert turned == pytest.approx(2 / np.pi * (np.arctan(np.sqrt(2)) - np.arctan(np.sqrt(0.5))))
    # The same linear map of both changes nothing.
    first, second = np.array([0.3, 0.1, 0.2]), np.array([0.5, -0.2, 0.4])
    scaled = total_variation(first * [4, 2, 1], second * [4, 2, 1])
    assert scaled == pytest.approx(total_variation(first, second), abs=1e-14)
    # No distribution belongs to a matrix that is not positive definite.
    assert np.isnan(total_variation(one, np.array([1.0, 2.0, 1.0])))
    assert np.isnan(total_variation(one, np.array([-1.0, 0.0, -1.0])))
