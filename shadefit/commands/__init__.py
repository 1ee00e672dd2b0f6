"""The commands of `shadefit`: each has a file with its options, its help, and what it does.

The modules that a command needs are imported when it runs, so that help and completion do not wait
for JAX.
"""
