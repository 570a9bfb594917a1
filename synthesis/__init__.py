"""Chooses gains."""
