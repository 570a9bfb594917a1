"""Gains for robots and for papers: C, ROS 2, LaTeX, CSV, Markdown."""
