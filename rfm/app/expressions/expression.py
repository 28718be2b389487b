"""An expression of a case file, and the field it stands for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from rfm.app.expressions.conditions import positive_where
from rfm.app.expressions.nodes import Constant, Node, is_condition, variables
from rfm.app.expressions.parser import Names, parse
from rfm.app.expressions.syntax import ExpressionError
from rfm.app.expressions.vocabulary import COORDINATES, VARIABLES
from rfm.calculus.types import Value

Path: TypeAlias = tuple[str | int, ...]


@dataclass(frozen=True, eq=False)
class ExpressionField:
    """The field of an expression: called with coordinates that are numbers, arrays, jets or intervals.

    Attributes
    ----------
    source
        Text of the expression.
    arguments
        Names of the arguments in the order of the call, e.g. ``("x", "y")``.
    path
        Where the user wrote it, as a path in the case.
    """

    source: str
    node: Node
    arguments: tuple[str, ...]
    path: Path = ()

    def __call__(self, *coords: Value) -> Value:
        """Value at a point; infinite or not a number where the formula has no value, without warnings."""
        if len(coords) != len(self.arguments):
            raise TypeError(
                f"{self.source!r} is a field of ({', '.join(self.arguments)}), got {len(coords)} arguments"
            )
        values = [np.float64(c) if isinstance(c, float | int) else c for c in coords]
        with np.errstate(all="ignore"):
            return self.node.evaluate(dict(zip(self.arguments, values, strict=True)))


@dataclass(frozen=True)
class Expression:
    """A number or a formula over coordinates and parameters.

    Parameters
    ----------
    text
        The formula, e.g. ``sin(pi*x) * (R^2 - y^2)``.
    parameters
        Values of the names it may mention besides the variables.
    variables
        Variables it may mention.
    absent
        Remarks for variables without a value where it is used.

    Raises
    ------
    ExpressionError
        The text is wrong; carries the offset of the mistake.

    References
    ----------
    Shapiro, *Semi-analytic geometry with R-functions*, Acta Numerica 2007, section 5 (conditions as functions).
    """

    text: str
    parameters: Mapping[str, float] = field(default_factory=dict, repr=False, compare=False)
    variables: tuple[str, ...] = field(default=VARIABLES, repr=False, compare=False)
    absent: Mapping[str, str] | None = field(default=None, repr=False, compare=False)
    node: Node = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "node", parse(self.text, Names(self.parameters, self.variables, self.absent))
        )

    @property
    def constant(self) -> float | bool | None:
        """Value of an expression without variables, else None."""
        return self.node.value if isinstance(self.node, Constant) else None

    @property
    def is_condition(self) -> bool:
        """Whether it is a comparison rather than a number."""
        return is_condition(self.node)

    @property
    def uses(self) -> frozenset[str]:
        """Variables on which it depends."""
        return variables(self.node)

    def field(self, dimension: int, path: Path = (), extra: tuple[str, ...] = ()) -> ExpressionField:
        """Field of the first `dimension` coordinates, followed by the arguments `extra`.

        Raises
        ------
        ExpressionError
            The expression depends on a variable that is not among the arguments.
        """
        return ExpressionField(self.text, self.node, self._arguments(dimension, extra), path)

    def condition(self, dimension: int, path: Path = ()) -> ExpressionField:
        """Field that is positive where the comparison holds, negative where it does not.

        Raises
        ------
        ExpressionError
            It is no comparison, or holds everywhere or nowhere.
        """
        if not self.is_condition:
            raise ExpressionError("a condition such as x > 0.2 is expected", self.text, 0)
        if isinstance(self.node, Constant):
            always = "everywhere" if self.node.value else "nowhere"
            raise ExpressionError(f"the condition holds {always}; it must depend on the point", self.text, 0)
        try:
            node = positive_where(self.node)
        except ValueError as error:
            raise ExpressionError(str(error), self.text, 0) from None
        return ExpressionField(self.text, node, self._arguments(dimension, ()), path)

    def _arguments(self, dimension: int, extra: tuple[str, ...]) -> tuple[str, ...]:
        arguments = (*COORDINATES[:dimension], *extra)
        for name in sorted(self.uses - set(arguments)):
            message = f"{name!r} has no value here, only {', '.join(arguments)}"
            raise ExpressionError(message, self.text, max(self.text.find(name), 0))
        return arguments
