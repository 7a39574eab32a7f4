"""Lemke's method, equation (7), and frictional systems advanced by it."""
