"""Compiling and running exported code on this machine, with one file for each language.

A toolchain says whether it can run code of a precision here, and evaluates the printed code of a
function at given points. If a tool is not installed, the toolchain names it and the package that
holds it. No tool is imported or started before it is needed.
"""

from programs.toolchains.interface import Toolchain as Toolchain
from programs.toolchains.process import ToolchainError as ToolchainError
from programs.toolchains.registry import TOOLCHAINS as TOOLCHAINS
from programs.toolchains.registry import toolchain as toolchain
