"""Certificates: written with witnesses, checked by verify/kernel.py, with repairs and remarks."""
