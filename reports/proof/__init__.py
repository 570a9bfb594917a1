"""The proof report in JSON, Markdown, HTML and LaTeX."""
