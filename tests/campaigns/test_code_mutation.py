"""The campaign code_mutation.py: its changes, what it leaves out, and that every argument is up to date."""

import ast
import sys
import types

import pytest

from tests.campaigns import code_mutation as mutation

SOURCE = '''
"""A docstring."""
LIMIT: int = 3


@cache
def worst(values: list[int], strict: bool = True) -> int:
    """Another one."""
    if not values:
        raise FalseError("1" + "2")
    for a, b in zip(values, values, strict=True):
        if a < b:
            continue
        total += abs(a)
        print(f"{a + b}", "a text")
    return min(values)
'''


def changes(source: str) -> list[str]:
    return [mutant.change for mutant in mutation.mutants(ast.parse(source))]


def test_every_kind_of_change_is_made_and_no_other() -> None:
    assert changes(SOURCE) == [
        "LIMIT: int = 3 -> LIMIT: int = 4",
        "LIMIT: int = 3 -> LIMIT: int = 2",
        "values: list[int], strict: bool=True -> values: list[int], strict: bool=False",
        "not values -> values",
        "raise FalseError('1' + '2') -> nothing",
        "FalseError('1' + '2') -> '1' + '2'",
        "a < b -> a <= b",
        "a < b -> a >= b",
        "continue -> nothing",
        "total += abs(a) -> total -= abs(a)",
        "total += abs(a) -> nothing",
        "abs(a) -> a",
        "print(f'{a + b}', 'a text') -> nothing",
        "return min(values) -> return None",
        "min(values) -> values",
        "min(values) -> max(values)",
    ]


@pytest.mark.parametrize(
    "source", ["'a b'", "f'{1}'", "import os", "unreadable('no')", "if __name__ == '__main__': f(1)"]
)
def test_what_no_test_can_see_is_left_out(source: str) -> None:
    assert not [change for change in changes(source) if "unreadable" not in change]


def test_a_loaded_function_takes_the_code_of_a_mutant() -> None:
    source = "def half(x):\n    return x / 2\n"
    module = types.ModuleType("halves")
    module.__file__ = "halves.py"
    exec(compile(source, "halves.py", "exec"), vars(module))  # noqa: S102
    held, tree = module.half, ast.parse(source)
    mutant = next(found for found in mutation.mutants(tree) if found.change == "x / 2 -> x * 2")
    assert (held(6), mutant.function, mutant.line, mutant.inside) == (3, "half", 2, True)
    mutant.apply()
    mutation.exchange(module, tree)
    assert held(6) == 12


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
def test_an_outcome_is_killed_survived_or_timed_out() -> None:
    def forever() -> bool:
        while True:
            pass

    assert mutation.outcome(lambda: True, 10) == mutation.SURVIVED
    assert mutation.outcome(lambda: False, 10) == mutation.KILLED
    assert mutation.outcome(lambda: [][0], 10) == mutation.KILLED
    assert mutation.outcome(forever, 0.1) == mutation.TIMED_OUT


def test_every_argument_is_about_a_mutant_that_there_is() -> None:
    known = set()
    for key, target in mutation.TARGETS.items():
        tree = ast.parse((mutation.ROOT / (target.module.replace(".", "/") + ".py")).read_text())
        known |= {(key, mutant.function, mutant.change) for mutant in mutation.mutants(tree)}
    assert not mutation.ARGUED.keys() - known
