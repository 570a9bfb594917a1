"""The algebras over which equations and conditions are written once: NumPy, SymPy, CasADi and cvxpy."""
