"""From text to Python's syntax tree, without evaluating anything and with offsets that fit the text.

``^`` is a power in arithmetic.  Python writes it ``**``, so the text is translated before it is parsed, and
`Syntax.offset` maps a column of the translation back to the text.  Among shapes it is the exclusive or, as in
Python; there dots and colons are parts of names (``ralpha0.5``, ``spline3:group4``), and letters stand for them.
"""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass

from rfm.errors import CaseError

MAX_LENGTH = 4000

_ALLOWED = re.compile(r"[A-Za-z0-9_ .+\-*/^(),<>=!\s]*", re.ASCII)
_DOMAIN_ALLOWED = re.compile(r"[A-Za-z0-9_ &|^@.:,\-~()\s]*", re.ASCII)

_LETTERS = {".": "\u00b7", ":": "\u02d0"}
"""Letters of Python's identifiers that occur in no text that is allowed here."""

_ARITHMETIC = {"^": "**"}

_REMEDIES = {
    "invalid decimal literal": "a product is written with *, as in 2*x",
    "invalid syntax. Perhaps you forgot a comma?": "an operator or a comma is missing",
}


class ExpressionError(CaseError):
    """An expression is wrong at character `offset` of its text."""

    def __init__(self, message: str, text: str, offset: int) -> None:
        from rfm.app.source import excerpt

        flat = " ".join(text.split("\n"))
        super().__init__(message, excerpt=excerpt(flat, offset + 1))
        self.offset = offset


@dataclass(frozen=True)
class Syntax:
    """A parsed text: the tree, and for each column of the translation the offset in the text."""

    text: str
    tree: ast.expr
    offsets: tuple[int, ...]

    def offset(self, node: ast.AST) -> int:
        """Offset in the text at which a node begins."""
        return self.offsets[min(getattr(node, "col_offset", 0), len(self.offsets) - 1)]

    def error(self, message: str, node: ast.AST) -> ExpressionError:
        """Error that points to a node."""
        return ExpressionError(message, self.text, self.offset(node))


def parse_arithmetic(text: str) -> Syntax:
    """Syntax of an arithmetic expression.

    Raises
    ------
    ExpressionError
        The text is empty, too long, holds a character that no expression needs, or is no expression.
    """
    return _parse(text, _ALLOWED, _ARITHMETIC, "expression")


def parse_boolean(text: str) -> Syntax:
    """Syntax of an expression of shapes (names, ``& | - ^ ~ @``, calls and parentheses)."""
    return _parse(text, _DOMAIN_ALLOWED, _LETTERS, "domain")


def written(name: str) -> str:
    """Name as it stands in the text of a domain."""
    for sign, letter in _LETTERS.items():
        name = name.replace(letter, sign)
    return name


def _parse(text: str, allowed: re.Pattern[str], translation: Mapping[str, str], what: str) -> Syntax:
    if not text.strip():
        raise ExpressionError(f"the {what} is empty", text, 0)
    if len(text) > MAX_LENGTH:
        message = f"the {what} is longer than {MAX_LENGTH} characters; split it with parameters"
        raise ExpressionError(message, text, MAX_LENGTH)
    match = allowed.match(text)
    end = match.end() if match else 0
    if end < len(text):
        raise ExpressionError(f"the character {text[end]!r} has no meaning in the {what}", text, end)
    translated, offsets = _translate(text, translation)
    return Syntax(text, _tree(text, translated, offsets, what), offsets)


def _translate(text: str, translation: Mapping[str, str]) -> tuple[str, tuple[int, ...]]:
    """Text for Python's parser on one line, and the offset in `text` of each of its characters."""
    pieces, offsets = [], []
    start = len(text) - len(text.lstrip())
    for i in range(start, len(text)):
        piece = " " if text[i].isspace() else translation.get(text[i], text[i])
        pieces.append(piece)
        offsets.extend([i] * len(piece))
    return "".join(pieces), (*offsets, len(text.rstrip()))


def _tree(text: str, translated: str, offsets: tuple[int, ...], what: str) -> ast.expr:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(translated, mode="eval").body
    except SyntaxError as error:
        last = len(offsets) - 1
        column = min(error.offset - 1, last) if error.offset else last
        reason = _REMEDIES.get(error.msg, error.msg) if error.offset else f"the {what} ends too early"
        raise ExpressionError(f"syntax error: {reason}", text, offsets[column]) from None
    except (ValueError, MemoryError, RecursionError, OverflowError):
        message = f"the {what} is nested too deeply or holds too long a number"
        raise ExpressionError(message, text, 0) from None
