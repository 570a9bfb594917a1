"""Tables for terminals, files and reports."""
