"""Processes that work side by side, on this machine or on a cluster. None of their results is lost.

A task is a value that can be pickled, and so is the function that is called with it. If a process
ends in the middle of a task, for lack of memory or because someone stops it, another one takes the
task over. Results come in the order in which they are ready.
"""

import multiprocessing
import os
import signal
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from programs.toolchains.running import end_all
from programs.toolchains.temporary import discard_unfinished

# Processes may end this many times before the work is given up: a task may be what ends them.
_LOSSES = 5
# The seconds that a cluster has to answer.
_PATIENCE = 20


@runtime_checkable
class Workers(Protocol):
    """What calls a function with many tasks at a time."""

    def results(
        self, function: Callable[[Any], Any], tasks: Sequence[Any]
    ) -> Iterator[tuple[Any, Any]]:
        """Yield each task with its result, as soon as it is ready."""
        ...


@dataclass(frozen=True)
class LocalProcesses:
    """A number of processes on this machine. They end when the process that started them does."""

    count: int

    def results(
        self, function: Callable[[Any], Any], tasks: Sequence[Any]
    ) -> Iterator[tuple[Any, Any]]:
        """Yield each task with its result. Raises ValueError if processes end again and again."""
        # The fork of a process in which JAX has threads may hang.
        context = multiprocessing.get_context("spawn")
        waiting, losses = list(range(len(tasks))), 0
        while waiting:
            count = min(self.count, len(waiting))
            with ProcessPoolExecutor(count, mp_context=context, initializer=_prepare) as pool:
                futures = {pool.submit(function, tasks[k]): k for k in waiting}
                try:
                    for each in as_completed(futures):
                        result = each.result()
                        waiting.remove(futures[each])
                        yield tasks[futures[each]], result
                except BrokenProcessPool:
                    losses += 1
                    for each, k in futures.items():
                        if k in waiting and _has_result(each):
                            waiting.remove(k)
                            yield tasks[k], each.result()
                except BaseException:
                    pool.shutdown(wait=False, cancel_futures=True)
                    raise
            if losses > _LOSSES:
                raise ValueError(
                    f"processes ended {losses} times before their work was done, perhaps for lack "
                    "of memory: try fewer at a time"
                )


@dataclass(frozen=True)
class Cluster:
    """The workers of a dask cluster, by the address of its scheduler, such as tcp://host:8786."""

    address: str

    def results(
        self, function: Callable[[Any], Any], tasks: Sequence[Any]
    ) -> Iterator[tuple[Any, Any]]:
        """Yield each task with its result.

        Raises ValueError without the package `distributed`, if no scheduler answers, and if the
        workers end again and again.
        """
        try:
            # An optional package
            from distributed import Client, KilledWorker, as_completed  # noqa: PLC0415
            from distributed.comm import get_address_host_port  # noqa: PLC0415
        except ImportError:
            raise ValueError(
                "a cluster needs dask: pip install 'shadefit[cluster]' installs it"
            ) from None
        try:
            # A client that refuses its address itself tries for 40 s to close what it never opened.
            get_address_host_port(self.address, strict=True)
            client = Client(self.address, timeout=_PATIENCE, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            reason = f"{error}".splitlines()[0] if f"{error}" else "no answer"
            raise ValueError(f"no dask scheduler at {self.address!r}: {reason}") from None
        with client:
            # Without `pure`, dask would take the results of an earlier search for a task's.
            futures = client.map(function, list(tasks), pure=False)
            numbers = {each.key: k for k, each in enumerate(futures)}
            try:
                for each in as_completed(futures, loop=client.loop):
                    yield tasks[numbers[each.key]], each.result()
            except KilledWorker as error:
                raise ValueError(
                    f"workers of {self.address} end again and again: {error}"
                ) from None


def _has_result(future: Future) -> bool:
    return future.done() and not future.cancelled() and future.exception() is None


def _prepare() -> None:
    """Prepare a process: it leaves Ctrl-C to the one that started it, and ends with that one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.filterwarnings("ignore", message="Error (reading|writing) persistent compilation")
    parent = multiprocessing.parent_process()
    assert parent is not None

    def end_with_parent() -> None:
        parent.join()
        end_all()
        discard_unfinished(at_end=True)
        os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()
