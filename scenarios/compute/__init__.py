"""How results are computed: what is in this folder, with an engine's own, decides the numbers that are stored."""
