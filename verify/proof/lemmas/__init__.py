"""The lemmas L0-L18 of the corrected theorem."""
