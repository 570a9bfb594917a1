"""Runs of one fleet: the integrators, disturbances, events between points, invariants."""
