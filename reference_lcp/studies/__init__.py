"""How large the errors are: error bars, convergence, speed."""
