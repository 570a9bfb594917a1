"""Figures and animations as files."""
