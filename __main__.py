"""`python -m gaincert`."""

from .cli import main

main()
