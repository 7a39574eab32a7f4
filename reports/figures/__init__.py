"""The pictures of the report, one module a subject; each draws the same numbers for print and for the screen."""
