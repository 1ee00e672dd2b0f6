"""Exported code compiled and run on this machine, one file a language.

A toolchain says whether it can run a precision here, and evaluates a function's printed code at
given points. What is not installed is reported as missing, with what would install it; nothing
beyond NumPy is imported, and no program is started, before it is asked for.
"""

from programs.toolchains.process import ToolchainError as ToolchainError
from programs.toolchains.registry import TOOLCHAINS as TOOLCHAINS
from programs.toolchains.registry import toolchain as toolchain
from programs.toolchains.interface import Toolchain as Toolchain
