"""The commands of `shadefit`, a file each: options and help, and what is done with them.

What a command works with is imported when it runs, so that help and completion do not wait for JAX.
"""
