"""`python -m gaincert` and the command `gaincert`."""

from __future__ import annotations


def main() -> None:
    """Run the command line; an interrupt while it loads prints no traceback."""
    try:
        from .cli import main as command_line

        command_line()
    except KeyboardInterrupt:
        raise SystemExit(130) from None


if __name__ == "__main__":
    main()
