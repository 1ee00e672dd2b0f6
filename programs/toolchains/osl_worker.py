"""A worker process that compiles and renders OSL with Blender; `osl.py` starts it as a file.

It runs in the folder of its input and output files. Arguments: `--version`; or `compile` and the
shaders' numbers; or `render`, the numbers of rows and of columns, and the shaders' numbers. The
scene is a plane seen by an orthographic camera, with one pixel for each row. The row's inputs are
texels at that pixel, and its values are the light that the plane emits there.
"""

import math
import sys
from array import array
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, cast

# Blender's modules may be built for another version of NumPy, and do not need NumPy here.
sys.modules["numpy"] = cast(ModuleType, None)
# Imported by name, because type checkers run where they are not installed.
bpy: Any = import_module("bpy")
_cycles: Any = import_module("_cycles")

HERE = Path.cwd()
LEAST = 4  # pixels: the width and height of Blender's smallest picture


def compile_shaders(numbers: list[str]) -> None:
    """Compile every shader; exit with status 1 if one is refused."""
    for number in numbers:
        path = HERE / f"probe{number}"
        if not _cycles.osl_compile(f"{path}.osl", f"{path}.oso"):
            sys.exit(1)


def write_textures(rows: int, columns: int, width: int, height: int) -> None:
    """Write the inputs to textures of three columns each, row by row from the lower left corner."""
    inputs = array("f", (HERE / "inputs").read_bytes())
    for index in range(-(-columns // 3)):
        pixels = array("f", bytes(16 * width * height))
        for channel in range(min(3, columns - 3 * index)):
            pixels[channel : 4 * rows : 4] = inputs[3 * index + channel :: columns]
        image = bpy.data.images.new(
            f"in{index}", width, height, alpha=True, float_buffer=True, is_data=True
        )
        image.pixels.foreach_set(pixels)
        image.save_render(str(HERE / f"in{index}.exr"), scene=bpy.context.scene)


def build_scene(width: int, height: int) -> None:
    """Put a plane of this width and height before a camera that sees one unit in each pixel."""
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    corners = [(0, 0, 0), (width, 0, 0), (width, height, 0), (0, height, 0)]
    mesh = bpy.data.meshes.new("plane")
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    scene.collection.objects.link(bpy.data.objects.new("plane", mesh))
    lens = bpy.data.cameras.new("camera")
    lens.type = "ORTHO"
    lens.ortho_scale = max(width, height)
    camera = bpy.data.objects.new("camera", lens)
    camera.location = (width / 2, height / 2, 1)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = None
    scene.view_settings.view_transform = "Raw"

    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.use_compositing = render.use_sequencer = False
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGBA"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "NONE"
    cycles.device = "CPU"
    cycles.shading_system = True
    cycles.samples = 1
    cycles.max_bounces = 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    # One sample close to the centre of the pixel, so that none falls on a neighbouring pixel.
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = 0.01
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0


def render_shader(number: str, width: int, height: int) -> None:
    """Render the plane with one shader and write the pixels without any transform."""
    material = bpy.data.materials.new(f"probe{number}")
    if material.node_tree is None:
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new("ShaderNodeScript")
    node.mode = "EXTERNAL"
    node.filepath = str(HERE / f"probe{number}.oso")
    for name, value in (("columns", width), ("rows", height)):
        socket = node.inputs.new("NodeSocketFloat", name, identifier=name)
        socket.default_value = float(value)
    node.outputs.new("NodeSocketShader", "Out", identifier="Out")
    target = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], target.inputs["Surface"])
    mesh = bpy.data.meshes["plane"]
    mesh.materials.clear()
    mesh.materials.append(material)

    picture = str(HERE / f"out{number}.exr")
    bpy.context.scene.render.filepath = picture
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(picture)
    image.colorspace_settings.name = "Non-Color"
    pixels = array("f", bytes(16 * width * height))
    image.pixels.foreach_get(pixels)
    (HERE / f"values{number}").write_bytes(pixels.tobytes())


def main(words: list[str]) -> None:
    """Do one of the three tasks."""
    if words[0] == "--version":
        osl = "".join(str(part) for part in _cycles.osl_version_string).replace(" ", "")
        print(f"OSL {osl.replace(',', '.')} in Blender {bpy.app.version_string}, Cycles")
    elif words[0] == "compile":
        compile_shaders(words[1:])
    else:
        rows, columns = int(words[1]), int(words[2])
        width = max(LEAST, math.ceil(math.sqrt(rows)))
        height = max(LEAST, -(-rows // width))
        build_scene(width, height)
        write_textures(rows, columns, width, height)
        for number in words[3:]:
            render_shader(number, width, height)


if __name__ == "__main__":
    main(sys.argv[1:])
