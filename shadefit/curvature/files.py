"""Mesh files: OBJ, PLY and glTF are read through trimesh, and PLY with curvature is written."""

import io
import re
from pathlib import Path
from typing import Any

import numpy as np

from coefficients.input_files import read_bounded
from shadefit.curvature.gltf_accessors import require_bounded_accessors
from shadefit.curvature.meshes import LARGEST_COUNT, UNITS, Mesh, mesh
from shadefit.curvature.tensors import Curvature
from shadefit.curvature.vertex_bytes import to_bytes
from shading.curvature.packing import RANGE

SUFFIXES = (".obj", ".ply", ".gltf", ".glb")
LARGEST_FILE = 2 * 1024**3
_VERTEX_0 = re.compile(rb"^[ \t]*f(?:[ \t]+[^ \t\r\n]+)*?[ \t]+[+-]?0+(?=[/\s]|\Z)", re.MULTILINE)


def read_mesh(path: Path, unit: str) -> Mesh:
    """Return the mesh of a file in a unit of `UNITS`, with all of its parts and their normals.

    The parts of a scene are placed as the file says. Materials are not read. Raises ValueError if
    trimesh is not installed, and for what is no mesh file or has no triangles. A glTF file may
    refer to files in its own folder only.
    """
    if unit not in UNITS:
        raise ValueError(f"unit {unit!r} is not known: allowed are {', '.join(UNITS)}")
    if path.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{path}: allowed are files that end with {', '.join(SUFFIXES)}")
    content = read_bounded(path, LARGEST_FILE)
    # trimesh takes vertex 0 for the last one.
    if path.suffix.lower() == ".obj" and _VERTEX_0.search(content):
        raise ValueError(f"{path}: a face has vertex 0: allowed are numbers from 1, or below 0")
    if path.suffix.lower() in (".gltf", ".glb"):
        require_bounded_accessors(content, path)
    data = io.BytesIO(content)
    try:
        import trimesh  # noqa: PLC0415
    except ImportError:
        raise ValueError(
            "meshes are read by trimesh, which is not installed: pip install 'shadefit[meshes]'"
        ) from None
    try:
        # Vertices that are not finite are refused below.
        with np.errstate(all="ignore"):
            scene = trimesh.load_scene(
                data,
                file_type=path.suffix.lower()[1:],
                resolver=_beside(path.parent),
                process=False,
                skip_materials=True,
            )
            parts = list(_parts(scene))
    # A damaged file makes trimesh raise errors of any type.
    except Exception as error:
        text = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"{path} cannot be read as a mesh: {text[:200]}") from None
    if not parts:
        raise ValueError(f"{path} has no triangles")
    starts = np.cumsum([0, *(len(places) for places, _, _ in parts)])
    triangles = [each + start for (_, each, _), start in zip(parts, starts, strict=False)]
    try:
        return mesh(
            np.concatenate([places for places, _, _ in parts]),
            np.concatenate(triangles),
            np.concatenate([normals for _, _, normals in parts]),
            unit=unit,
        )
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def ply_bytes(
    shape: Mesh, found: Curvature, largest: float = RANGE, drift: np.ndarray | None = None
) -> bytes:
    """Return a binary PLY file in mm of a mesh with its curvature.

    A vertex has x y z, nx ny nz, the tangent tx ty tz, the tensor ii_tt ii_tb ii_bb in 1/mm, and
    the signed bytes packed_tt packed_tb packed_bb packed_mean of the range ±`largest`. The
    bitangent is n × t. With a `drift` (n, 2) of the normal, drift_t drift_b in 1/mm² follow the
    tensor.
    """
    names = ["x", "y", "z", "nx", "ny", "nz", "tx", "ty", "tz", "ii_tt", "ii_tb", "ii_bb"]
    columns = [shape.vertices, shape.normals, found.frames[:, 0], found.tensors]
    if drift is not None:
        names += ["drift_t", "drift_b"]
        columns.append(drift)
    packed = ["packed_tt", "packed_tb", "packed_bb", "packed_mean"]
    fields = [*((name, "<f4") for name in names), *((name, "i1") for name in packed)]
    vertices = np.empty(len(shape.vertices), fields)
    for name, column in zip(names, np.hstack(columns).T, strict=True):
        vertices[name] = column
    for name, column in zip(packed, to_bytes(found.tensors, largest).T, strict=True):
        vertices[name] = column
    faces = np.empty(len(shape.triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, shape.triangles
    header = [
        "ply",
        "format binary_little_endian 1.0",
        "comment lengths in mm, curvature in 1/mm, positive where convex; bitangent = n x t",
        f"comment packed_* are 127 curvature / {largest:g}, of the tensor and its half trace",
        f"element vertex {len(vertices)}",
        *(f"property {'float' if kind == '<f4' else 'char'} {name}" for name, kind in fields),
        f"element face {len(faces)}",
        "property list uchar int vertex_indices",
        "end_header\n",
    ]
    return "\n".join(header).encode() + vertices.tobytes() + faces.tobytes()


def _parts(scene: Any):
    """Yield vertices, triangles and normals of the parts of a scene; no normals are zeros."""
    total = 0
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        part = scene.geometry[name]
        if not len(getattr(part, "faces", ())):
            continue
        # A part may be placed many times.
        total += max(len(part.vertices), len(part.faces))
        if total > LARGEST_COUNT:
            raise ValueError(f"its parts have more than {LARGEST_COUNT} vertices or triangles")
        places = np.asarray(part.vertices, float) @ matrix[:3, :3].T + matrix[:3, 3]
        normals = np.zeros_like(places)
        # Normals of the file are in the cache; trimesh would compute others if asked for them.
        if "vertex_normals" in part._cache.cache:
            # The adjugate is the inverse's transpose times the determinant, and never fails.
            first, second, third = matrix[:3, :3]
            adjugate = np.stack(
                [np.cross(second, third), np.cross(third, first), np.cross(first, second)]
            )
            side = np.sign(np.linalg.det(matrix[:3, :3])) or 1.0
            normals = np.asarray(part._cache.cache["vertex_normals"]) @ adjugate.T * side
        yield places, np.asarray(part.faces, np.int64), normals


def _beside(folder: Path):
    """Return a resolver of names that reads plain files of one folder and nothing else."""
    from trimesh.resolvers import Resolver  # noqa: PLC0415

    class Beside(Resolver):
        def __init__(self) -> None:
            pass

        def get(self, key: str) -> bytes:
            name = key
            found = folder / name
            if Path(name).name != name or found.is_symlink():
                raise ValueError(f"it refers to {name!r}: allowed are files beside it")
            return read_bounded(found, LARGEST_FILE)

        def keys(self) -> list[str]:
            return []

        def namespaced(self, namespace: str) -> "Beside":
            raise ValueError(f"it refers to the folder {namespace!r}: allowed are files beside it")

        def write(self, name: str, data: Any) -> None:
            raise ValueError(f"{name!r} is not written: allowed is reading")

    return Beside()
