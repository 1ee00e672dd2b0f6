"""The points at which forms are fitted, checked for large errors, and judged."""
