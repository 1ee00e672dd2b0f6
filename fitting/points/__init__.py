"""Where forms are fitted, checked and judged."""
