"""The search in the time domain: exploration, CMA-ES runs, halving, final ranking."""
