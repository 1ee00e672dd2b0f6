"""Tables of coefficients: published, refitted and best ones, as JSON files below `tables/`.

The modules read and write tables, find them by name (`catalogue`), compare them, search for better
ones, and write their shader code with a header that states their errors (`exported_code`).
"""
