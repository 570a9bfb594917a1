"""Checks what was chosen, and trusts nobody."""
