"""The convex and smooth programs that propose gains, rates, an excitation and link weights."""
