"""The curvature tensor of one triangle, after Rusinkiewicz 2004.

"Estimating curvatures and their derivatives on triangle meshes". Along each edge e of a triangle
with vertex normals, II (e·t, e·b) = (Δn·t, Δn·b). These six equations for three unknowns are solved
by least squares, in closed form. `corner_areas` is the mixed Voronoi area of Meyer et al. 2003, by
which the tensors of triangles are weighted at a vertex.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import Array
from jax.typing import ArrayLike
from jaxtyping import Float

from shading.curvature.frames import carried, tangent_frame

Corners = Float[ArrayLike, "3 3"]
# A triangle is degenerate if its height is less than this part of its longest edge: the rounding
# of coordinates in float32 may then decide its normal.
LEAST_HEIGHT = 1e-6


class FaceTensor(NamedTuple):
    """The tensor (3,) of a triangle in its frame (2, 3), in 1/unit of the corners.

    `sound` is false for a degenerate triangle, whose tensor is zero.
    """

    tensor: Array
    frame: Array
    sound: Array


def face_tensor(corners: Corners, normals: Corners) -> FaceTensor:
    """Return the tensor of a triangle with three corners and their unit normals.

    The tangent of its frame is along the edge from corner 1 to corner 2. The tensor's sign comes
    from the vertex normals; it does not depend on the order of the corners. All values and
    gradients are finite, those of degenerate triangles too.
    """
    corners, normals = jnp.asarray(corners), jnp.asarray(normals)
    edges, longest2 = _edges(corners)
    cross = jnp.cross(edges[0], edges[1])
    sound = cross @ cross > LEAST_HEIGHT**2
    # A sound triangle in place of a degenerate one keeps gradients finite.
    edges = jnp.where(sound, edges, jnp.eye(3) - jnp.roll(jnp.eye(3), 1, axis=1))
    cross = jnp.cross(edges[0], edges[1])
    area2 = cross @ cross
    tangent = edges[0] / jnp.sqrt(edges[0] @ edges[0])
    frame = jnp.stack([tangent, jnp.cross(cross / jnp.sqrt(area2), tangent)])
    differences = jnp.roll(normals, 1, axis=0) - jnp.roll(normals, 2, axis=0)
    u, v = frame @ edges.T
    p, q = frame @ differences.T
    uu, uv, vv = u @ u, u @ v, v @ v
    sums = jnp.stack([u @ p, v @ p + u @ q, v @ q])
    # The adjoint of the normal equations [uu uv 0; uv uu+vv uv; 0 uv vv]. uu·vv − uv² is three
    # times the squared area of the parallelogram, because the edges sum to zero.
    trace, determinant = uu + vv, 3 * area2
    adjoint = jnp.stack(
        [
            jnp.stack([trace * vv - uv * uv, -uv * vv, uv * uv]),
            jnp.stack([-uv * vv, uu * vv, -uu * uv]),
            jnp.stack([uv * uv, -uu * uv, trace * uu - uv * uv]),
        ]
    )
    found = adjoint @ sums / (trace * determinant) / jnp.sqrt(longest2)
    return FaceTensor(jnp.where(sound, found, 0.0), frame, sound)


def corner_areas(corners: Corners) -> Array:
    """Return the mixed Voronoi area (3,) of each corner of a triangle. They sum to its area.

    A triangle without an obtuse angle gives each corner what is nearer to it than to the others.
    With an obtuse angle, that corner has half of the area, and the others a quarter.
    """
    edges, longest2 = _edges(jnp.asarray(corners))
    cross = jnp.cross(edges[0], edges[1])
    squared = cross @ cross
    doubled = jnp.where(squared > 0, jnp.sqrt(jnp.where(squared > 0, squared, 1.0)), 0.0)
    # The cosine at corner k times the lengths of its two edges
    dots = -jnp.sum(jnp.roll(edges, 1, axis=0) * jnp.roll(edges, 2, axis=0), axis=1)
    lengths2 = jnp.sum(edges * edges, axis=1)
    opposite = lengths2 * dots / (8 * jnp.where(squared > 0, doubled, 1.0))
    voronoi = jnp.roll(opposite, 1) + jnp.roll(opposite, 2)
    mixed = doubled * jnp.where(dots < 0, 1 / 4, 1 / 8)
    areas = jnp.where(jnp.any(dots < 0), mixed, voronoi)
    return jnp.where(squared > 0, areas, 0.0) * longest2


def corner_tensors(corners: Corners, normals: Corners) -> tuple[Array, Array, Array]:
    """Return a triangle's tensor (3, 3) at its corners, its corner areas (3,), and if it is sound.

    The tensor of a corner is in the frame `tangent_frame` of the corner's normal. The normal of the
    triangle is turned to the side of the corner's before the tensor is carried there.
    """
    face = face_tensor(corners, normals)
    normals = jnp.asarray(normals)
    areas = corner_areas(corners)

    def at(normal: Array) -> Array:
        turned = jnp.where(jnp.cross(*face.frame) @ normal < 0, -1.0, 1.0)
        sides = jnp.stack([jnp.ones(()), turned])
        # With one axis turned, the entry of both axes has the other sign.
        tensor = face.tensor * jnp.stack([jnp.ones(()), turned, jnp.ones(())])
        return carried(tensor, face.frame * sides[:, None], tangent_frame(normal))

    return jax.vmap(at)(normals), jnp.where(face.sound, areas, 0.0), face.sound


def _edges(corners: Array) -> tuple[Array, Array]:
    """Return edges (3, 3) divided by the longest, and its squared length. Edge k faces corner k."""
    edges = jnp.roll(corners, 1, axis=0) - jnp.roll(corners, 2, axis=0)
    longest2 = jnp.max(jnp.sum(edges * edges, axis=1))
    safe = jnp.where(longest2 > 0, longest2, 1.0)
    return edges / jnp.sqrt(safe), safe
