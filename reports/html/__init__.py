"""report.html: one page with all results of an output folder."""
