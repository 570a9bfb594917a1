"""Runs of one fleet: integrators, disturbances, events between grid points, invariants."""
