"""Generic shapes of forms."""
