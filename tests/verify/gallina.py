"""Reads the definitions of a Coq file and evaluates those that are numbers, over Python floats.

The part of the language that `Statement.v` uses: records, numbers, + - * / ^, functions and their application, `if`,
and the words of logic, which are read but not evaluated. `sum` is evaluated as the loop that its Fixpoint describes.
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

TOKEN = re.compile(r"\s*(\d+|[A-Za-z_][\w']*|:=|=>|->|/\\|\\/|<=|[-+*/^()<=~,:%.|{}])")
# Operators from loose to tight, as Coq binds them; what binds to the right is marked.
LEVELS = [["->"], ["\\/"], ["/\\"], ["=", "<", "<="], ["+", "-"], ["*", "/"], ["^"]]
RIGHT = {"->", "\\/", "/\\", "^"}
SUM = "Fixpoint sum (n : nat) (f : nat -> R) : R := match n with O => 0 | S p => sum p f + f p end."


class Apply(NamedTuple):
    function: Any
    argument: Any


class Operation(NamedTuple):
    sign: str
    parts: tuple[Any, ...]


class Bind(NamedTuple):
    """`fun names => body`, `forall names, body` or `exists names, body`."""

    word: str
    names: tuple[str, ...]
    body: Any


class Choice(NamedTuple):
    condition: Any
    then: Any
    otherwise: Any


def without_comments(text: str) -> str:
    kept, depth = [], 0
    for part in re.split(r"(\(\*|\*\))", text):
        depth += {"(*": 1, "*)": -1}.get(part, 0)
        if depth == 0 and part != "*)":
            kept.append(part)
    return "".join(kept)


class Parser:
    """Reads one expression by precedence climbing."""

    def __init__(self, text: str) -> None:
        self.tokens = TOKEN.findall(text)
        assert "".join(self.tokens) == re.sub(r"\s", "", text), "a sign that this reader does not know"

    def next(self) -> str:
        return self.tokens.pop(0)

    def at(self, *signs: str) -> bool:
        return bool(self.tokens) and self.tokens[0] in signs

    def expect(self, sign: str) -> None:
        assert self.next() == sign, sign

    def expression(self, level: int = 0) -> Any:
        if level == len(LEVELS):
            return self.application()
        if level == LEVELS.index(["*", "/"]) and self.at("-"):
            self.next()
            left: Any = Operation("-", (self.expression(level + 1),))
        elif self.at("~"):
            self.next()
            left = Operation("~", (self.expression(LEVELS.index(["=", "<", "<="])),))
        else:
            left = self.expression(level + 1)
        while self.at(*LEVELS[level]):
            sign = self.next()
            left = Operation(sign, (left, self.expression(level if sign in RIGHT else level + 1)))
        return left

    def application(self) -> Any:
        found = self.atom()
        while self.tokens and re.match(r"[\w(]", self.tokens[0]) and not self.at("then", "else"):
            found = Apply(found, self.atom())
        return found

    def atom(self) -> Any:
        word = self.next()
        if word == "(":
            inside = self.expression()
            self.expect(")")
            if self.at("%"):
                self.next(), self.next()
            return inside
        if word in ("fun", "forall", "exists"):
            names = self.binders("=>" if word == "fun" else ",")
            return Bind(word, names, self.expression())
        if word == "if":
            condition = self.expression()
            self.expect("then")
            then = self.expression()
            self.expect("else")
            return Choice(condition, then, self.expression())
        return float(word) if word.isdigit() else word

    def binders(self, end: str) -> tuple[str, ...]:
        names, in_type, depth = [], False, 0
        while not (self.at(end) and depth == 0):
            word = self.next()
            depth += {"(": 1, ")": -1}.get(word, 0)
            if word == ":":
                in_type = True
            elif word not in "()" and not in_type:
                names.append(word)
            if depth == 0 and word == ")":
                in_type = False
        self.next()
        return tuple(names)


class Source:
    """The definitions of a Coq file, by name."""

    def __init__(self, text: str) -> None:
        text = " ".join(without_comments(text).split())
        assert SUM in text
        self.definitions: dict[str, Any] = {}
        for name, parameters, body in re.findall(r"Definition (\w+)(.*?):=(.*?)\.(?= |$)", text):
            names = Parser(parameters + "=>").binders("=>")
            parsed = Parser(body).expression()
            self.definitions[name] = Bind("fun", names, parsed) if names else parsed
        self.known: dict[str, Any] = {name: getattr(math, name) for name in ("sin", "cos", "tanh", "sqrt")}
        self.known |= {"Rabs": abs, "RInt": integral}
        self.known["sum"] = lambda n: lambda f: sum(f(k) for k in range(n))
        for fields in re.findall(r"Record \w+ := \w+ {(.*?)}", text):
            self.known |= {name: field(name) for name in re.findall(r"(\w+) :", fields)}

    def value(self, name: str, *arguments: Any) -> Any:
        """A definition applied to its arguments; fleets and states are mappings from field to value."""
        value = self.evaluate(name, {})
        for argument in arguments:
            value = value(argument)
        return value

    def evaluate(self, expression: Any, local: Mapping[str, Any]) -> Any:
        """The value of an expression, where `local` holds the names that are bound around it."""
        match expression:
            case float():
                return expression
            case str() if expression in local:
                return local[expression]
            case str() if expression in self.known:
                return self.known[expression]
            case str():
                return self.evaluate(self.definitions[expression], {})
            case Apply(function, argument):
                return self.evaluate(function, local)(self.evaluate(argument, local))
            case Bind("fun", names, body):
                return self._function(names, body, local)
            case Choice(condition, then, otherwise):
                return self.evaluate(then if self.evaluate(condition, local) else otherwise, local)
            case Operation("-", (only,)):
                return -self.evaluate(only, local)
            case Operation(sign, parts):
                return ARITHMETIC[sign](*(self.evaluate(part, local) for part in parts))
        raise AssertionError(f"not a number: {expression}")

    def _function(self, names: tuple[str, ...], body: Any, local: Mapping[str, Any]) -> Any:
        if not names:
            return self.evaluate(body, local)
        return lambda value: self._function(names[1:], body, {**local, names[0]: value})

    def parts(self, name: str) -> Iterator[Any]:
        """Every expression inside a definition, in the order of the text."""
        waiting = [self.definitions[name]]
        while waiting:
            part = waiting.pop()
            yield part
            if isinstance(part, tuple):
                inside = part.parts if isinstance(part, Operation) else part[2:] if isinstance(part, Bind) else part
                waiting += reversed(inside)

    def derivatives(self, name: str) -> dict[str, Any]:
        """{field: d} for every `is_derive (fun t => field (X t) i) t d` in a definition."""
        found = {}
        for part in self.parts(name):
            match part:
                case Apply(Apply(Apply("is_derive", Bind("fun", _, Apply(Apply(quantity, _), _))), "t"), rate):
                    found[quantity] = rate
        return found

    def comparisons(self, name: str, sign: str) -> list[tuple[Any, ...]]:
        """Both sides of every comparison with this sign in a definition."""
        return [part.parts for part in self.parts(name) if isinstance(part, Operation) and part.sign == sign]


def integral(f: Callable[[float], float]) -> Callable[[float], Callable[[float], float]]:
    """RInt f a b for a trigonometric sum over whole periods of it, where the mean of few values is exact."""
    return lambda a: lambda b: (b - a) * sum(f(a + (b - a) * k / 64) for k in range(64)) / 64


def field(name: str) -> Callable[[Mapping[str, Any]], Any]:
    """The function that takes this field of a record."""
    return lambda record: record[name]


ARITHMETIC: dict[str, Callable[[float, float], float]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "^": lambda a, b: a**b,
}
