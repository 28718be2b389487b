"""No text whatever makes an expression name, call or reach anything outside the whitelist."""

import ast
import builtins

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rfm.app.domain import DomainExpression
from rfm.app.expressions import CONSTANTS, FUNCTIONS, VARIABLES, Expression, ExpressionError
from rfm.app.expressions.conditions import _conjunction, _disjunction
from rfm.app.expressions.nodes import Apply, Chain, Comparison, Constant, Logical, Variable
from rfm.app.expressions.parser import Names, _negative, _Parser
from rfm.app.expressions.syntax import parse_arithmetic

ALLOWED_CALLS = {*FUNCTIONS.values(), _negative, _conjunction, _disjunction}

WORDS = [
    *VARIABLES, *CONSTANTS, *FUNCTIONS, "R", "u", "__import__", "eval", "exec", "open", "getattr", "globals",
    "__class__", "__builtins__", "lambda", "if", "else", "for", "in", "is", "and", "or", "not", "await", "yield",
    "None", "True", "import", "os", "system", "f", "b", "print", "x1", "_",
]  # fmt: skip
SIGNS = [
    *"()[]{}.,:;+-*/^%@&|~<>=!'\"#\\ \n\t0123456789",
    "**",
    "//",
    "==",
    "<=",
    ":=",
    "->",
    "1e9",
    "1j",
    "0x1",
    "...",
]
TOKENS = st.lists(st.sampled_from([*WORDS, *SIGNS]), max_size=14)

ATTACKS = [
    "__import__('os').system('true')", "().__class__.__bases__[0].__subclasses__()", "(lambda: 1)()", "x.__class__",
    "[x for x in (1,)]", "{x: 1}", "f'{x}'", "(x := 1)", "sin.__call__(1)", "sin(x)(y)", "sin(**x)", "sin(*x)",
    "min(x, key=y)", "getattr(x, y)", "x[0]", "x[0:1]", "print(x)", "exec(x)", "(yield)", "await x", "x if y else 1",
    "1 if 1 else 1", "'a' * 9", "b'a'", "...", "True", "None", "x @ y", "x << 9", "x >> 1", "~x", "x | y", "x % 2",
    "not not x", "sin", "(x)(y)", "9**9**9", "9^9^9^9", "1e400", "0**-1", "1/0", "-" * 99, "(((((",
    "x\x00y", "x;y", "x\\\ny", "x#y", "ｘ + 1", "sin（x）", "\u202ex", "import os", "def f(): 1", "x = 1", "𝐱",
]  # fmt: skip


def check_tree(node):
    """Only whitelisted nodes, functions and variables."""
    match node:
        case Constant(value):
            assert isinstance(value, float | bool)
        case Variable(name):
            assert name in VARIABLES
        case Chain(first, rest):
            check_tree(first)
            for symbol, item in rest:
                assert symbol in ("+", "-", "*", "/", "^")
                check_tree(item)
        case Apply(function, arguments):
            assert function in ALLOWED_CALLS
            for item in arguments:
                check_tree(item)
        case Comparison(symbol, left, right):
            assert symbol in ("<", "<=", ">", ">=", "==", "!=")
            check_tree(left)
            check_tree(right)
        case Logical(symbol, arguments):
            assert symbol in ("and", "or", "not")
            for item in arguments:
                check_tree(item)
        case _:
            raise AssertionError(type(node))


def outcome(parse, text):
    """Result of a parser, or None after an error that points into the text; anything else fails the test."""
    refusal = None
    try:
        return parse(text)
    except ExpressionError as error:
        refusal = error
    assert 0 <= refusal.offset <= max(len(text), 1)
    assert refusal.message
    return None


def parse_or_refuse(text):
    expression = outcome(lambda t: Expression(t, {"R": 0.4}), text)
    if expression is not None:
        check_tree(expression.node)


@pytest.mark.parametrize("text", ATTACKS)
def test_known_attacks(text):
    with pytest.raises(ExpressionError):
        Expression(text, {"R": 0.4})


@settings(max_examples=800, deadline=None)
@given(TOKENS.map("".join))
def test_random_tokens(text):
    parse_or_refuse(text)


@settings(max_examples=500, deadline=None)
@given(TOKENS.map(" ".join))
def test_random_tokens_apart(text):
    parse_or_refuse(text)


@settings(max_examples=500, deadline=None)
@given(st.text(max_size=40))
@example("\ud800")
def test_random_text(text):
    parse_or_refuse(text)


@settings(max_examples=300, deadline=None)
@given(
    st.lists(
        st.sampled_from([*"abc", *"&|-~()^", "iff(", ",", "lambda", "1", ".", "not", "+"]), max_size=12
    ).map(" ".join)
)
def test_random_domains(text):
    domain = outcome(DomainExpression.parse, text)
    if domain is not None:
        universe = frozenset(range(8))
        domain.evaluate(
            {name: Set(universe, frozenset({i, i + 2, 7})) for i, name in enumerate(domain.names)}
        )


class Set:
    """Subsets of a universe with the operators of shapes."""

    def __init__(self, universe, members):
        self.universe, self.members = universe, members

    def __and__(self, other):
        return Set(self.universe, self.members & other.members)

    def __or__(self, other):
        return Set(self.universe, self.members | other.members)

    def __sub__(self, other):
        return Set(self.universe, self.members - other.members)

    def __xor__(self, other):
        return Set(self.universe, self.members ^ other.members)

    def __invert__(self):
        return Set(self.universe, self.universe - self.members)


@pytest.mark.parametrize(
    ("text", "members"),
    [
        ("a - b", {0}),
        ("a | b & c", {0, 1, 2}),
        ("~a", {3, 4}),
        ("~a & b", {3}),
        ("a - (b - c)", {0, 2}),
        ("a - b - c", {0}),
        ("~(a | b)", {4}),
        ("a ^ b", {0, 3}),
        ("a ^ b ^ c", {0, 2, 3}),
        ("a & b ^ c | c", {1, 2}),
        ("implies(a, b)", {1, 2, 3, 4}),
        ("iff(a, b)", {1, 2, 4}),
    ],
)
def test_domains_are_set_algebra(text, members):
    universe = frozenset(range(5))
    sets = {"a": Set(universe, {0, 1, 2}), "b": Set(universe, {1, 2, 3}), "c": Set(universe, {2})}
    assert DomainExpression.parse(text).evaluate(sets).members == members


@pytest.mark.parametrize(
    ("text", "offset", "words"),
    [
        ("", 0, "empty"),
        ("a -", 3, "ends too early"),
        ("a + b", 2, "'+'"),
        ("-a", 0, "complement is written ~"),
        ("a(b)", 0, "neither implies, iff nor a system"),
        ("imply(a)", 0, "did you mean 'implies'"),
        ("rp3(a & b)", 0, "even p"),
        ("ralpha1.5(a & b)", 0, "-1 < alpha < 1"),
        ("rp4(a, b)", 0, "takes one expression"),
        ("implies(a)", 0, "takes two shapes"),
        ("a - b.left", 4, "'b.left' is no name of a shape"),
        ("spline9(a & b)", 0, "spline"),
        ("a ^ (b, c)", 4, "only names"),
        ("a b", 2, "syntax"),
        ("1", 0, "only names"),
        ("(a", 0, "never closed"),
        ("a and b", 0, "only names"),
    ],
)
def test_domains_that_are_none(text, offset, words):
    with pytest.raises(ExpressionError) as caught:
        DomainExpression.parse(text)
    assert words in caught.value.message
    assert caught.value.offset == offset


def test_every_other_kind_of_syntax_is_refused():
    """The parser knows seven kinds of node; an expression of any other kind cannot pass."""
    kinds = {"Constant", "Name", "BinOp", "UnaryOp", "Compare", "BoolOp", "Call"}
    refused = {
        name
        for name in dir(ast)
        if isinstance(getattr(ast, name), type) and issubclass(getattr(ast, name), ast.expr)
    } - kinds
    parser = _Parser(parse_arithmetic("x"), Names({}))
    for name in refused - {"expr", "Num", "Str", "Bytes", "NameConstant", "Ellipsis", "Index", "ExtSlice"}:
        with pytest.raises(ExpressionError):
            parser.node(getattr(ast, name)(), 0)


def test_nothing_of_python_can_be_named():
    for name in dir(builtins):
        if name.isidentifier() and name not in {*FUNCTIONS, "True", "False", "None", "__debug__"}:
            for text in (name, f"{name}(x)", f"x + {name}"):
                with pytest.raises(ExpressionError):
                    Expression(text)
