"""report.html: one page of all that lies in an output folder."""
