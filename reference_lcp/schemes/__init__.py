"""Time stepping by Euler's scheme: compiled, by Lemke's method, one lane after the other."""
