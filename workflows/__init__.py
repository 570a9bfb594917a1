"""What each verb of the command line does, one file for each; `run` is the pipeline of the others.

A workflow computes, writes its files whole, says what happened, and returns a typed result. Everything heavy is
imported by the function that needs it.
"""
