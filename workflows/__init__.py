"""One workflow for each verb of the command line; `run` is the pipeline of the others.

A workflow computes, writes its files whole, prints what happened, and returns a typed result. Everything heavy is
imported by the function that needs it.
"""
