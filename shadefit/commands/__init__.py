"""The commands' options and help, by what they are about.

The work is in the modules of `shadefit`, which are imported when a command runs: help and
completion do not wait for JAX.
"""
