# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters of an LS-DYNA keyword file, and their expressions (*PARAMETER, *PARAMETER_EXPRESSION).

A parameter is given before it is used. Of two definitions the first holds unless it is MUTABLE or
*PARAMETER_DUPLICATION says otherwise, and a local one is known in its file and those that it includes. The quotient of
two whole numbers is a whole number (LS-DYNA Keyword User's Manual, Vol. I, *PARAMETER).
"""
import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from typing import Any

from dd3.errors import Problem

Value = int | float
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD]?[+-]\d+|[eEdD]\d+)?", re.ASCII)
LONGEST = 2000  # characters of an expression
LARGEST = 1e300
REDEFINED = (2, 4)  # values of DFLAG with which a second definition holds


def nearest(value: Value) -> int:
    """Return the nearest whole number, as Fortran does: halves go away from zero."""
    return math.trunc(value + math.copysign(0.5, value))


FUNCTIONS: dict[str, Callable[..., Value]] = {
    "abs": abs, "aint": lambda x: float(math.trunc(x)), "nint": nearest, "anint": lambda x: float(nearest(x)),
    "int": math.trunc, "floor": math.floor, "ceil": math.ceil, "float": float, "mod": math.fmod,
    "sign": math.copysign, "max": max, "min": min, "sqrt": math.sqrt, "exp": math.exp, "log": math.log,
    "log10": math.log10, "sin": math.sin, "cos": math.cos, "tan": math.tan, "asin": math.asin, "acos": math.acos,
    "atan": math.atan, "atan2": math.atan2, "sinh": math.sinh, "cosh": math.cosh, "tanh": math.tanh}
OPERATORS: dict[type, Callable[[Any, Any], Value]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul}


def as_number(word: str) -> float | None:
    """Return the finite number of a word, None for none; 1.5+3 is 1500 and 1D3 1000, as Fortran reads them."""
    if not NUMBER.fullmatch(word):
        return None
    try:
        value = float(word)
    except ValueError:
        value = float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"e\1", word.lower().replace("d", "e")))
    return value if math.isfinite(value) else None


class Parameters:
    """The values of the parameters in a file by name; those of the file in which it is included are known in it.

    `values` is replaced, not changed: a card keeps those that were known when it was read.
    """

    def __init__(self, above: "Parameters | None" = None) -> None:
        self.above = above
        self.values: Mapping[str, Value | str] = dict(above.values) if above else {}
        self.shared: dict[str, Value | str] = above.shared if above else {}
        self.mutable: set[str] = above.mutable if above else set()
        self.policy: list[int] = above.policy if above else []
        self.twice: list[tuple[str, str]] = above.twice if above else []  # place and name of what is given again

    def take_back(self, inner: "Parameters") -> None:
        """Know what a file that was included has defined, but for its local parameters."""
        self.values = {**inner.shared, **self.values}

    def duplication(self, flag: int) -> None:
        """Take *PARAMETER_DUPLICATION; the first holds."""
        self.policy.append(flag)

    def define(self, place: str, keyword: str, name: str, text: str) -> None:
        """Take a definition, its name with the letter of its kind before it."""
        kind, name = name[:1].upper(), name[1:].strip().upper()
        if kind not in "RIC" or not name:
            raise Problem(f"{place}: error: expected a parameter, R, I or C and its name, got '{kind}{name}'")
        local = "LOCAL" in keyword
        known = name in self.values if local else name in self.shared
        if known and not (local and name in self.shared) and name not in self.mutable:
            policy = self.policy[0] if self.policy else 1
            if policy == 3:
                raise Problem(f"{place}: error: a second *PARAMETER {name}, which *PARAMETER_DUPLICATION forbids")
            if policy not in REDEFINED:
                self.twice.append((place, name))
                return
        if "MUTABLE" in keyword and not known:
            self.mutable.add(name)
        value: Value | str = text
        if kind != "C":
            value = evaluate(text, self.values, place) if "EXPRESSION" in keyword else plain(text, self.values, place)
            value = math.trunc(value) if kind == "I" else float(value)
        if not local:
            self.shared[name] = value
        self.values = {**self.values, name: value}


def plain(text: str, values: Mapping[str, Value | str], place: str) -> Value:
    """Return the number of a field: a number, &name, -&name, or an expression of parameters."""
    number = as_number(text)
    if number is not None:
        return number
    if text.startswith("<") and text.endswith(">"):
        return evaluate(text[1:-1], values, place)
    if "&" in text:
        return evaluate(text, values, place)
    raise Problem(f"{place}: error: expected a number, got '{text}'")


def evaluate(text: str, values: Mapping[str, Value | str], place: str) -> Value:
    """Return the value of an expression."""
    words = re.sub(r"(?<![\w.])(\d+\.?\d*|\.\d+)[dD](?=[+-]?\d)", r"\1e", text.replace("&", " "))
    try:
        if len(words) > LONGEST:
            raise ValueError("it is too long")
        found = node_value(ast.parse(words.strip(), mode="eval").body, values, place)
        if not abs(found) < LARGEST:
            raise ValueError("the value is too large")
    except (SyntaxError, ValueError, TypeError, ArithmeticError, RecursionError, MemoryError) as error:
        why = "it cannot be read" if isinstance(error, SyntaxError) else str(error)
        raise Problem(f"{place}: error: the expression '{text.strip()[:80]}': {why}") from None
    return found


def node_value(node: ast.expr, values: Mapping[str, Value | str], place: str) -> Value:
    """Return the value of a part of an expression."""
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return node.value if abs(node.value) < LARGEST else math.inf
    if isinstance(node, ast.Name):
        name = node.id.upper()
        if name == "PI" and name not in values:
            return math.pi
        if name not in values:
            raise Problem(f"{place}: error: no *PARAMETER '{node.id}' is given before this line")
        value = values[name]
        if isinstance(value, str):
            raise Problem(f"{place}: error: the parameter '{node.id}' is a text; expected a number")
        return value
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.UAdd, ast.USub)):
        value = node_value(node.operand, values, place)
        return -value if isinstance(node.op, ast.USub) else value
    if isinstance(node, ast.BinOp):
        return binary(type(node.op), node_value(node.left, values, place), node_value(node.right, values, place))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if node.func.id.lower() not in FUNCTIONS:
            raise ValueError(f"the function {node.func.id} is not known")
        return FUNCTIONS[node.func.id.lower()](*(node_value(item, values, place) for item in node.args))
    raise ValueError("expected numbers, parameters, + - * / ** and functions")


def binary(kind: type, left: Value, right: Value) -> Value:
    """Return the value of an operation; of whole numbers it is whole."""
    whole = isinstance(left, int) and isinstance(right, int)
    if kind in OPERATORS:
        value = OPERATORS[kind](left, right)
        return value if abs(value) < LARGEST else math.inf
    if kind is ast.Div:
        return math.trunc(left / right) if whole else left / right
    if kind is ast.Pow:
        value = float(left)**float(right)
        return int(value) if whole and right >= 0 and abs(value) < 1e15 else value
    raise ValueError("expected numbers, parameters, + - * / ** and functions")
