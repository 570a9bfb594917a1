"""Tables on a terminal: columns that do not fit continue below, with the first column repeated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...models.errors import one_line

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.table import Table

GAP = 2  # characters between columns, at most


@dataclass(frozen=True)
class TerminalTable:
    """A table that rich prints: headings, and rows of as many texts."""

    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str | None = None

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Table]:
        """As few tables below each other as the width permits."""
        blocks = self.blocks(options.max_width)
        for number, columns in enumerate(blocks):
            yield self._table(columns, self.caption if number == len(blocks) - 1 else None)

    def blocks(self, width: int) -> list[list[int]]:
        """The columns of every table, each with column 0 and at least one other."""
        sizes = [GAP + max(map(len, column)) for column in zip(*self._texts, strict=True)]
        blocks, used = [[0]], sizes[0]
        for column in range(1, len(sizes)):
            if used + sizes[column] > width and len(blocks[-1]) > 1:
                blocks.append([0])
                used = sizes[0]
            blocks[-1].append(column)
            used += sizes[column]
        return blocks

    @property
    def _texts(self) -> list[list[str]]:
        return [list(self.headings), *([one_line(text) for text in row] for row in self.rows)]

    def _table(self, columns: list[int], caption: str | None) -> Table:
        from rich.box import SIMPLE_HEAD
        from rich.table import Table
        from rich.text import Text

        shown = Table(box=SIMPLE_HEAD, padding=(0, 1, 0, 0), caption=caption, caption_justify="left")
        for column in columns:
            # The first column holds names, which may be long; numbers are never broken.
            shown.add_column(
                self.headings[column],
                justify="right" if column else "left",
                no_wrap=column > 0,
                overflow="fold",
            )
        for row in self._texts[1:]:
            shown.add_row(*(Text(row[column]) for column in columns))
        return shown
