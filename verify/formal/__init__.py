"""The machine-checked theorem: Statement.v says what is proved, `make formal` proves it again."""
