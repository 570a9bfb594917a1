"""Runs from many starts: local or on a cluster, resumed, replayed, summarised."""
