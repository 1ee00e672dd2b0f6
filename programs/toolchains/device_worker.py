"""A process of its own that runs compute shaders; started by `device.py`, run as a file.

It talks over the connection whose descriptor is its argument: a request in, a reply out, until the
other end closes. Graphics drivers print, start threads and, at worst, end the process: all that
stays here. It imports nothing of this project, so that it starts quickly.
"""

import sys
from functools import partial
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any

# By name, since a checker of types runs where it is not installed.
wgpu: Any = import_module("wgpu")

GROUP = 64
ROWS = 1 << 18  # one dispatch: far below the limits on groups (65535) and on buffer sizes


def adapter():
    """Choose the first Vulkan adapter; None when there is none."""
    found = wgpu.gpu.enumerate_adapters_sync()
    return next((one for one in found if one.info["backend_type"] == "Vulkan"), None)


def describe(device) -> dict:
    """Name the device, its driver, and which of the optional number types it has."""
    found = device.adapter
    return {
        "name": f"{found.info['device']}, {found.info['description']}",
        "wgpu": wgpu.__version__,
        "features": sorted(found.features & {"shader-f16", "shader-f64"}),
    }


def dispatch(device, code, data: bytes, rows: int, item: int, width: int, count: int) -> bytes:
    """Run the entry point `main` once a row: `width` numbers of `item` bytes in, `count` out."""
    module = device.create_shader_module(code=code)
    pipeline = device.create_compute_pipeline(
        layout="auto", compute={"module": module, "entry_point": "main"}
    )
    usage = wgpu.BufferUsage
    parts = []
    for start in range(0, rows, ROWS):
        part = min(ROWS, rows - start)
        # Every thread has a row of its own: the last group's spare threads repeat the last row.
        padded = -(-part // GROUP) * GROUP
        block = data[start * width * item : (start + part) * width * item]
        block += block[-width * item :] * (padded - part)
        source = device.create_buffer_with_data(data=block, usage=usage.STORAGE)
        size = padded * count * item
        target = device.create_buffer(size=size, usage=usage.STORAGE | usage.COPY_SRC)
        entries = [
            {"binding": index, "resource": {"buffer": buffer, "offset": 0, "size": buffer.size}}
            for index, buffer in enumerate((source, target))
        ]
        group = device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=entries)
        encoder = device.create_command_encoder()
        compute = encoder.begin_compute_pass()
        compute.set_pipeline(pipeline)
        compute.set_bind_group(0, group)
        compute.dispatch_workgroups(padded // GROUP)
        compute.end()
        device.queue.submit([encoder.finish()])
        parts.append(bytes(device.queue.read_buffer(target))[: part * count * item])
        source.destroy()
        target.destroy()
    return b"".join(parts)


def main() -> None:
    """Answer requests until the other end closes."""
    connection = Connection(int(sys.argv[1]))
    found = adapter()
    if found is None:
        connection.send((None, "no Vulkan adapter"))
        return
    wanted = found.features & {"shader-f16", "shader-f64"}
    device = found.request_device_sync(required_features=sorted(wanted))
    connection.send((describe(device), None))
    for request in iter(partial(receive, connection), None):
        try:
            reply = (dispatch(device, *request), None)
        except Exception as error:  # whatever the driver says goes back as the log
            reply = (None, str(error) or type(error).__name__)
        connection.send(reply)


def receive(connection: Connection):
    """Give the next request, or None when the other end has closed."""
    try:
        return connection.recv()
    except EOFError:
        return None


if __name__ == "__main__":
    main()
