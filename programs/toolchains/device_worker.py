"""A worker process that runs compute shaders; `device.py` starts it as a file.

Its argument is the file descriptor of a connection. It answers one request after the other until
the other end closes. Graphics drivers print, start threads and may crash; all of that stays in this
process. It imports nothing of this project, so that it starts quickly.
"""

import sys
from functools import partial
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any

# Imported by name, because type checkers run where it is not installed.
wgpu: Any = import_module("wgpu")

GROUP = 64
ROWS = 1 << 18  # in one dispatch: far below the limits on groups (65535) and on buffer sizes


def adapter():
    """Return the first Vulkan adapter, or None."""
    found = wgpu.gpu.enumerate_adapters_sync()
    return next((one for one in found if one.info["backend_type"] == "Vulkan"), None)


def describe(device) -> dict:
    """Describe the device: its name, its driver and its optional number types."""
    found = device.adapter
    return {
        "name": f"{found.info['device']}, {found.info['description']}",
        "wgpu": wgpu.__version__,
        "features": sorted(found.features & {"shader-f16", "shader-f64"}),
    }


def dispatch(device, code, data: bytes, rows: int, item: int, width: int, count: int) -> bytes:
    """Run the entry point `main` for every row: `width` numbers of `item` bytes in, `count` out."""
    module = device.create_shader_module(code=code)
    pipeline = device.create_compute_pipeline(
        layout="auto", compute={"module": module, "entry_point": "main"}
    )
    usage = wgpu.BufferUsage
    parts = []
    for start in range(0, rows, ROWS):
        part = min(ROWS, rows - start)
        # Every thread needs a row: spare threads of the last group repeat the last row.
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
        except Exception as error:  # the driver's message is sent back as the log
            reply = (None, str(error) or type(error).__name__)
        connection.send(reply)


def receive(connection: Connection):
    """Return the next request, or None when the other end has closed."""
    try:
        return connection.recv()
    except EOFError:
        return None


if __name__ == "__main__":
    main()
