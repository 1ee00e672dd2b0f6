"""Curvature of one triangle and one point: against exact values, and finite everywhere."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from shading import curvature

RANDOM = np.random.default_rng(3)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


TENSORS = RANDOM.normal(size=(200, 3)) * 0.2
LIGHTS = unit(RANDOM.normal(size=(200, 3)))[:, :2]


def matrix(tensor):
    return np.array([[tensor[0], tensor[1]], [tensor[1], tensor[2]]])


def test_frames_are_orthonormal_and_right_handed():
    extreme = [[0, 0, 1], [0, 0, -1], [1, 0, 0], [0, -1, -0.0], [0, 1e-9, -1]]
    normals = unit(np.concatenate([RANDOM.normal(size=(50, 3)), np.array(extreme, float)]))
    frames = np.asarray(jax.vmap(curvature.tangent_frame)(normals))
    gram = frames @ frames.transpose(0, 2, 1)
    np.testing.assert_allclose(gram, np.broadcast_to(np.eye(2), gram.shape), atol=1e-15)
    np.testing.assert_allclose(np.cross(frames[:, 0], frames[:, 1]), normals, atol=1e-15)


def test_the_shortest_arc_takes_start_to_end_and_keeps_what_is_orthogonal_to_both():
    start, end = unit(RANDOM.normal(size=(2, 50, 3)))
    turn = jax.vmap(curvature.rotated)
    np.testing.assert_allclose(turn(start, start, end), end, atol=1e-14)
    axis = np.cross(start, end)
    np.testing.assert_allclose(turn(axis, start, end), axis, atol=1e-14)
    opposite = curvature.rotated(np.array([0.0, 1, 0]), start[0], -start[0])
    np.testing.assert_allclose(opposite, [0, -1, 0], atol=1e-15)


def test_a_triangle_of_a_quadric_has_its_tensor():
    """Normals that are linear in the place satisfy all six equations, in both orders."""
    places = RANDOM.normal(size=(100, 3, 2))
    frames = np.array([[[1.0, 0, 0], [0, 1, 0]]] * 100)

    def tensor_of(corners, normals, frame):
        face = curvature.face_tensor(corners, normals)
        return curvature.expressed(face.tensor, face.frame, frame)

    corners = np.concatenate([places, np.zeros((100, 3, 1))], axis=2)
    second = np.array([matrix(each) for each in TENSORS[:100]])
    normals = np.concatenate([places @ second, np.ones((100, 3, 1))], axis=2)
    compiled = jax.jit(jax.vmap(tensor_of))
    for order in ([0, 1, 2], [1, 0, 2]):
        found = compiled(corners[:, order], normals[:, order], frames)
        np.testing.assert_allclose(found, TENSORS[:100], rtol=1e-8, atol=1e-10)


def test_corner_areas_sum_to_the_area_and_are_the_voronoi_areas():
    corners = RANDOM.normal(size=(100, 3, 3))
    areas = np.asarray(jax.jit(jax.vmap(curvature.corner_areas))(corners))
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    np.testing.assert_allclose(areas.sum(1), np.linalg.norm(cross, axis=1) / 2, rtol=1e-12)
    assert areas.min() >= 0
    even = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0]])
    np.testing.assert_allclose(curvature.corner_areas(even), np.sqrt(0.75) / 6, rtol=1e-14)
    # The angle at corner 1 is obtuse.
    wide = np.array([[0.0, 0, 0], [1, 0.1, 0], [2, 0, 0]])
    np.testing.assert_allclose(curvature.corner_areas(wide), [0.025, 0.05, 0.025], rtol=1e-12)


def test_curvatures_from_light_are_what_their_names_say():
    names = ("published", "along_light", "bending_along_light", "effective")

    def every(tensor, light):
        return {name: getattr(curvature, name)(tensor, light) for name in names}

    found = jax.jit(jax.vmap(every))(TENSORS, LIGHTS)
    second = np.array([matrix(each) for each in TENSORS])
    bent, square = (second @ LIGHTS[:, :, None])[:, :, 0], np.sum(LIGHTS**2, 1)
    quadratic, bent2 = np.sum(bent * LIGHTS, 1), np.sum(bent**2, 1)
    whole = np.sqrt(bent2 + (1 - square) * np.sum(second**2, (1, 2)))
    expected = (quadratic, quadratic / square, np.sqrt(bent2 / square), whole)
    for name, values in zip(names, expected, strict=True):
        np.testing.assert_allclose(found[name], values, rtol=1e-12, atol=1e-15, err_msg=name)


def test_on_a_sphere_the_directional_curvatures_agree():
    for light in LIGHTS[:3]:
        sphere = np.array([0.1, 0, 0.1])
        for name in ("along_light", "bending_along_light"):
            np.testing.assert_allclose(getattr(curvature, name)(sphere, light), 0.1, rtol=1e-14)
        expected = 0.1 * np.sqrt(2 - light @ light)
        np.testing.assert_allclose(curvature.effective(sphere, light), expected, rtol=1e-14)


def test_the_convex_part_clamps_eigenvalues():
    every = np.asarray(jax.jit(jax.vmap(curvature.convex_part))(TENSORS))
    for tensor, found in zip(TENSORS, every, strict=True):
        values, vectors = np.linalg.eigh(matrix(tensor))
        expected = vectors @ np.diag(np.maximum(values, 0)) @ vectors.T
        np.testing.assert_allclose(matrix(found), expected, atol=1e-15)


def test_a_cylinder_is_its_own_equivalent_and_the_scale_times_its_curvature_is_effective():
    """Its curvature does not depend on the light, and the scale is the part across the axis."""

    def every(tensor, light, cosine):
        found = curvature.equivalent_cylinder(tensor, light, cosine)
        return found, curvature.effective(tensor, light)

    heights = np.sqrt(1 - np.sum(LIGHTS**2, 1)) * np.where(RANDOM.random(200) < 0.5, -1, 1)
    compiled = jax.jit(jax.vmap(every))
    turn = RANDOM.uniform(0, np.pi, 200)
    x, y = np.cos(turn), np.sin(turn)
    cylinders = 0.2 * np.stack([x * x, x * y, y * y], 1)
    found, _ = compiled(cylinders, LIGHTS, heights)
    across2 = heights**2 + (x * LIGHTS[:, 0] + y * LIGHTS[:, 1]) ** 2
    np.testing.assert_allclose(found.scale, np.sqrt(across2), rtol=1e-13)
    np.testing.assert_allclose(found.curvature, 0.2, rtol=1e-13)
    np.testing.assert_allclose(found.cosine * found.scale, heights, rtol=1e-13, atol=1e-15)
    found, effective = compiled(TENSORS, LIGHTS, heights)
    np.testing.assert_allclose(found.scale * found.curvature, effective, rtol=1e-12)
    assert np.max(found.scale) <= 1 + 1e-14
    found, _ = compiled(0 * TENSORS, LIGHTS, heights)
    assert np.all(found.curvature == 0)
    np.testing.assert_allclose(found.cosine * found.scale, heights, rtol=1e-13)


def test_the_drift_moves_the_cosine_along_the_light():
    found = curvature.drifted(0.3, np.array([0.02, -0.01]), np.array([0.5, 0.2]), 1.4)
    np.testing.assert_allclose(found, 0.3 + 1.4 * (0.01 - 0.002), rtol=1e-14)
    # A cylinder that is lit across its axis has the scale 1, and more if a drift is added.
    for cosine in (0.6, 0.65):
        scale = curvature.equivalent_cylinder(
            np.array([0.1, 0.0, 0.0]), np.array([0.8, 0.0]), cosine
        ).scale
        np.testing.assert_allclose(scale, np.sqrt(0.64 + cosine**2), rtol=1e-14)


def _light_of_equivalent(tensor, light):
    return sum(curvature.equivalent_cylinder(tensor, light, 1 - jnp.max(jnp.abs(light))))


@pytest.mark.parametrize(
    "function",
    [
        curvature.published,
        curvature.along_light,
        curvature.bending_along_light,
        curvature.effective,
        _light_of_equivalent,
    ],
)
def test_values_and_gradients_are_finite_where_roots_and_quotients_are_zero(function):
    curve = jax.value_and_grad(function, argnums=(0, 1))
    tensors = jnp.array([[0.0, 0, 0], [0.1, 0, 0.1], [0.1, 0, -0.1], [0.2, 0, 0], [1e-300, 0, 0]])
    lights = jnp.array([[0.0, 0], [1, 0], [0, 1], [1e-200, 0], [0, 1e-8]])
    rows = [(t, v) for t in tensors for v in lights]
    found = jax.jit(jax.vmap(curve))(
        jnp.stack([r[0] for r in rows]), jnp.stack([r[1] for r in rows])
    )
    assert all(np.isfinite(each).all() for each in jax.tree.leaves(found))


@pytest.mark.slow
def test_gradients_of_tensors_are_finite_for_degenerate_triangles_and_equal_eigenvalues():
    tensors = jnp.array([[0.0, 0, 0], [0.1, 0, 0.1], [-0.1, 0, -0.1], [0.1, 0, -0.1]])
    assert np.isfinite(jax.jit(jax.vmap(jax.jacobian(curvature.convex_part)))(tensors)).all()
    triangles = jnp.array(
        [
            [[0.0, 0, 0], [0, 0, 0], [0, 0, 0]],
            [[0, 0, 0], [1, 0, 0], [1, 0, 0]],
            [[0, 0, 0], [1, 0, 0], [2, 0, 0]],
            [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        ]
    )
    normals = jnp.tile(jnp.array([0.0, 0, 1]), (3, 1))

    def total(corners, normals):
        tensors, areas, _ = curvature.corner_tensors(corners, normals)
        return jnp.sum(tensors) + jnp.sum(areas), (tensors, areas)

    slope = jax.jit(jax.vmap(jax.grad(total, argnums=(0, 1), has_aux=True), in_axes=(0, None)))
    found = slope(triangles, normals)
    assert all(np.isfinite(each).all() for each in jax.tree.leaves(found))
    assert np.all(np.asarray(found[1][1])[:3] == 0)


def test_packing_keeps_half_a_step_and_clamps_the_rest():
    tensors = RANDOM.uniform(-0.5, 0.5, (2000, 3))
    codes = np.asarray(jax.jit(jax.vmap(curvature.packed))(tensors))
    assert np.all(codes == np.round(codes)) and np.abs(codes).max() <= 127
    back = np.asarray(jax.jit(jax.vmap(curvature.unpacked))(codes))
    assert np.abs(back[:, :3] - tensors).max() <= curvature.packing_error() * (1 + 1e-12)
    assert curvature.packing_error() < 0.002
    np.testing.assert_array_equal(curvature.packed(np.array([9.0, -9.0, 0.0])), [127, -127, 0, 127])
    np.testing.assert_array_equal(curvature.unpacked(-128.0 * np.ones(4)), -0.5 * np.ones(4))
