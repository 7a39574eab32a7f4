"""How any figure is drawn: its parts as data, its style, on the page, in print, and what is drawn already."""
