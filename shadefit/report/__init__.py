"""One HTML page: the tables, the figures and an explorer."""
