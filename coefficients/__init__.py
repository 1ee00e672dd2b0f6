"""Tables of coefficients: published, refitted, compared, and written as JSON and shader code."""
