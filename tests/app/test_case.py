"""What a case may say and what becomes of it."""

import copy
import inspect
import math
from pathlib import Path

import numpy as np
import pytest

from rfm.app.build import build_discretization, build_domain, build_problem, solver_options
from rfm.app.case import Case, case_from_document, load_case
from rfm.app.expressions import FUNCTIONS
from rfm.app.memory import available_bytes, grid_cells, require_memory, required_bytes, shown
from rfm.app.schema.conditions import BoundaryCondition, ClampedEdge, FreeEdge, SupportedEdge
from rfm.app.schema.discretization import Discretization, Solver
from rfm.app.schema.equation import MODELS
from rfm.app.schema.results import Integral, Study
from rfm.app.schema.shapes import KINDS, AffineMap, Mirroring, ShapeSpec, Tapering
from rfm.app.source import from_text
from rfm.errors import CaseError, DiscretizationError
from rfm.geometry.derived import DERIVED
from rfm.geometry.primitives import KINDS as PRIMITIVES
from solvers.problem import FROM_EXACT, Dirichlet, Neumann, Robin

BASE = {
    "rfm": 1,
    "title": "Annulus",
    "parameters": {"R": 0.4, "r": "R/4", "c": 0.5},
    "geometry": {
        "shapes": {
            "outer": {"disk": {"center": ["c", "c"], "radius": "R"}},
            "inner": {"disk": {"center": ["c", "c"], "radius": "r"}},
        },
        "domain": "outer - inner",
    },
    "equation": {"poisson": {"source": "x + y^2", "conductivity": "1 + x", "reaction": 2}},
    "boundary_conditions": [
        {"on": "outer", "dirichlet": "R*x"},
        {"on": "inner", "robin": {"coefficient": "2", "value": "from exact"}},
    ],
    "exact": "x*y",
    "discretization": {"degree": 4, "grid": 20, "weight": "r0"},
    "solver": {"linear": "dense", "tolerance": 1e-10},
    "expect": {"relative_l2_error": 1e-3, "dofs": {"value": 100, "tolerance": "2*5"}},
    "study": {"grid": [4, 8], "degree": [1]},
    "probes": {"A": ["c", "c + R/2"]},
    "integrals": {"q": {"on": ["outer", "inner"], "of": "flux"}, "V": {"on": "domain", "of": "2*u"}},
}


def case_with(**changes) -> Case:
    return load_case({**copy.deepcopy(BASE), **changes})


def plane(shapes: dict, domain: str, conditions: list | None = None) -> Case:
    return load_case(
        {
            "rfm": 1,
            "geometry": {"shapes": shapes, "domain": domain},
            "equation": {"poisson": {"source": 1}},
            "boundary_conditions": conditions or [{"on": "all", "dirichlet": 0}],
        }
    )


def test_resolved_case():
    case = load_case(BASE)
    assert case.dimension == 2
    assert case.name == "annulus"
    assert case.parameters == {"R": 0.4, "r": 0.1, "c": 0.5}
    assert case.geometry.shapes["inner"].disk.radius == pytest.approx(0.1)
    assert case.probes["A"] == pytest.approx((0.5, 0.7))
    assert case.expect["relative_l2_error"].limit == 1e-3
    assert case.expect["dofs"].tolerance == 10


def test_resolved_case_can_be_read_again():
    resolved = load_case(BASE).to_dict()
    again = load_case(resolved)
    assert again.to_dict() == resolved
    assert resolved["equation"]["poisson"] == {"source": "x + y^2", "conductivity": "1 + x", "reaction": 2}
    assert resolved["discretization"]["basis"] == "web-spline"
    field = again.equation.poisson.source.field(2)
    assert field(1.0, 2.0) == 5.0


def test_file_and_mapping_agree(tmp_path):
    from ruamel.yaml import YAML

    file = tmp_path / "my case.yaml"
    with file.open("w") as stream:
        YAML(typ="safe", pure=True).dump(BASE, stream)
    case = load_case(file)
    assert case.to_dict() == load_case(BASE).to_dict()
    assert case.name == "my-case"
    assert case.file == str(file)


def test_problem_of_a_case():
    problem = build_problem(load_case(BASE))
    first, second = problem.conditions
    assert isinstance(first, Dirichlet)
    assert first.value.source == "R*x"
    assert first.value(2.0, 0.0) == pytest.approx(0.8)
    assert isinstance(second, Robin)
    assert second.coefficient == 2.0
    assert second.value is FROM_EXACT
    assert problem.equation.reaction == 2.0
    assert problem.equation.conductivity(1.0, 0.0) == 2.0
    assert problem.equation.conductivity.path == ("equation", "poisson", "conductivity")
    assert problem.exact(2.0, 3.0) == 6.0
    assert build_problem(case_with(equation={"poisson": {"source": "from exact"}})).equation.source is None


def test_discretization_and_solver_of_a_case():
    case = load_case(BASE, {"discretization.quadrature_points": 9, "discretization.moment_fitting": False})
    found = build_discretization(case, build_domain(case))
    assert (found.degree, found.grid, found.spacing, found.weight) == (4, 20, None, "r0")
    assert (found.quadrature_points, found.moment_fitting) == (9, False)
    assert solver_options(case).tolerance == 1e-10
    spaced = load_case(BASE, {"discretization": {"spacing": "R/8", "box": [[0, 0], [1, "2*c"]]}})
    found = build_discretization(spaced, build_domain(spaced))
    assert found.spacing == pytest.approx(0.05)
    assert found.box.upper == (1.0, 1.0)
    default = load_case(
        {key: value for key, value in BASE.items() if key not in ("discretization", "solver")}
    )
    assert build_discretization(default, build_domain(default)).grid == 32


def test_empty_sections_are_absent():
    case = load_case(
        BASE, {"parameters": None, "study": None, "probes": None, "geometry.shapes.inner": None} | PLAIN
    )
    assert case.study is None
    assert case.probes == {}
    assert case.parameters == {}


PLAIN = {
    "geometry": {"shapes": {"d": {"disk": {"center": [0, 0], "radius": 1}}}, "domain": "d"},
    "boundary_conditions": [{"on": "all", "dirichlet": 0}],
    "integrals": None,
    "expect": None,
}


def test_overrides_by_path():
    case = load_case(BASE, {"parameters.R": 0.45, "boundary_conditions.0.dirichlet": 3, "exact": "x + y"})
    assert case.geometry.shapes["outer"].disk.radius == 0.45
    assert case.boundary_conditions[0].dirichlet.constant == 3.0
    assert case.exact.text == "x + y"
    assert BASE["parameters"]["R"] == 0.4


CONSTRUCTORS = {**PRIMITIVES, **DERIVED}


def test_arguments_of_kinds_are_those_of_the_constructors():
    assert set(KINDS) == set(CONSTRUCTORS)
    for name, model in KINDS.items():
        signature = inspect.signature(CONSTRUCTORS[name])
        positional = [p for p in signature.parameters.values() if p.kind is not p.KEYWORD_ONLY]
        required = {p.name for p in positional if p.default is p.empty}
        assert set(model.model_fields) == {p.name for p in positional}, name
        assert {key for key, field in model.model_fields.items() if field.is_required()} == required, name


SHAPES = [
    ({"half_plane": {"point": [0, 0], "normal": [1, 1]}}, (1, 0), (-1, 0)),
    ({"ellipse": {"center": [0, 0], "semi_axes": [2, 1], "angle": 90}}, (0, 1.9), (1.9, 0)),
    ({"rectangle": {"min": [0, 0], "max": [2, 1]}}, (1.9, 0.9), (0.9, 1.9)),
    ({"strip": {"point": [0, 0], "normal": [0, 1], "width": 2}}, (9, 0.9), (0, 1.1)),
    ({"polygon": {"vertices": [[0, 0], [2, 0], [0, 2]]}}, (0.5, 0.5), (1.5, 1.5)),
    ({"function": {"expression": "1 - x^4 - y^4", "box": [[-1, -1], [1, 1]]}}, (0.8, 0.8), (0.9, 0.9)),
    ({"disk": {"center": [1, 0], "radius": 0.5}, "rotate": 90}, (0, 1), (1, 0)),
    ({"disk": {"center": [1, 0], "radius": 0.5}, "rotate": {"angle": 90, "center": [1, 1]}}, (2, 1), (1, 0)),
    ({"disk": {"center": [1, 0], "radius": 0.5}, "scale": 2, "rotate": 90, "move": [5, 0]}, (5, 2.9), (5, 0)),
]


@pytest.mark.parametrize(("shape", "inside", "outside"), SHAPES)
def test_shapes_of_the_plane(shape, inside, outside):
    frame = {"rectangle": {"min": [-20, -20], "max": [20, 20]}}
    domain = build_domain(plane({"s": shape, "frame": frame}, "s & frame"))
    assert domain.contains(np.array([inside, outside], dtype=float)).tolist() == [True, False]


SOLIDS = [
    ({"half_space": {"point": [0, 0, 0], "normal": [0, 0, 1]}}, (0, 0, 1), (0, 0, -1)),
    ({"ball": {"center": [0, 0, 0], "radius": 1}}, (0, 0, 0.9), (0, 0, 1.1)),
    ({"ellipsoid": {"center": [0, 0, 0], "semi_axes": [3, 1, 1], "angle": 90}}, (0, 2.9, 0), (2.9, 0, 0)),
    ({"box": {"min": [0, 0, 0], "max": [1, 2, 3]}}, (0.5, 1.9, 2.9), (1.9, 0.5, 0.5)),
    ({"slab": {"point": [0, 0, 0], "normal": [1, 0, 0], "width": 2}}, (0.9, 5, 5), (1.1, 0, 0)),
    (
        {"cylinder": {"center": [0, 0, 0], "axis": [0, 0, 1], "radius": 1, "height": 2}},
        (0, 0, 0.9),
        (0, 0, 1.1),
    ),
    ({"cylinder": {"center": [0, 0, 0], "axis": [0, 0, 1], "radius": 1}}, (0, 0, 9), (1.1, 0, 0)),
    ({"cone": {"apex": [0, 0, 0], "axis": [0, 0, 1], "radius": 1, "height": 2}}, (0.4, 0, 1), (0.6, 0, 1)),
    (
        {"torus": {"center": [0, 0, 0], "axis": [0, 0, 1], "major_radius": 2, "minor_radius": 0.5}},
        (2, 0, 0.4),
        (0, 0, 0),
    ),
    (
        {"ball": {"center": [1, 0, 0], "radius": 0.5}, "rotate": {"angle": 90, "axis": [0, 0, 1]}},
        (0, 1, 0),
        (1, 0, 0),
    ),
    ({"function": {"expression": "1 - x^2 - y^2 - z^2"}}, (0.5, 0.5, 0.5), (1, 1, 1)),
]


@pytest.mark.parametrize(("shape", "inside", "outside"), SOLIDS)
def test_shapes_of_space(shape, inside, outside):
    frame = {"box": {"min": [-20, -20, -20], "max": [20, 20, 20]}}
    case = plane({"s": shape, "frame": frame}, "s & frame")
    assert case.dimension == 3
    assert build_domain(case).contains(np.array([inside, outside], dtype=float)).tolist() == [True, False]


def test_parts_are_named_after_the_shapes():
    shapes = {
        "plate": {"rectangle": {"min": [0, 0], "max": [1, 1]}},
        "hole": {"disk": {"center": [0.5, 0.5], "radius": 0.1}},
    }
    domain = build_domain(plane(shapes, "plate - hole"))
    assert set(domain.parts) == {"plate", "plate.left", "plate.right", "plate.bottom", "plate.top", "hole"}


def test_polynomial_functions_keep_their_degree():
    shape = {"function": {"expression": "1 - x^2 - y^4", "box": [[-1, -1], [1, 1]]}}
    assert build_domain(plane({"s": shape}, "s")).surfaces[0].degree == 4


def test_rotation_in_space_needs_an_axis():
    with pytest.raises(CaseError, match="needs an axis"):
        plane({"s": {"ball": {"center": [1, 0, 0], "radius": 1}, "rotate": 90}}, "s")
    with pytest.raises(CaseError, match="has no axis"):
        plane(
            {"s": {"disk": {"center": [1, 0], "radius": 1}, "rotate": {"angle": 1, "axis": [0, 0, 1]}}}, "s"
        )


def test_function_alone_needs_a_box():
    with pytest.raises(CaseError, match="needs a box"):
        plane({"s": {"function": {"expression": "1 - x^2"}}}, "s")


# Which condition holds where ----------------------------------------------------------------------

SQUARE = {"s": {"rectangle": {"min": [0, 0], "max": [1, 1]}}}


def holds(
    conditions: list, point: tuple[float, float], shapes: dict = SQUARE, domain: str = "s"
) -> list[int]:
    """Conditions that hold at a point of the boundary, by the geometry of their parts."""
    problem = build_problem(plane(shapes, domain, conditions))
    found = []
    for i, condition in enumerate(problem.conditions):
        for piece in condition.part.pieces:
            near = any(abs(surface.function(*point)) < 1e-12 for surface in piece.surfaces)
            if near and piece.selects(np.array([point]))[0]:
                found.append(i)
    return found


def test_rest_takes_what_is_left():
    conditions = [{"on": ["s.left", "s.right"], "dirichlet": 1}, {"on": "rest", "neumann": 0}]
    assert holds(conditions, (0.0, 0.5)) == [0]
    assert holds(conditions, (1.0, 0.5)) == [0]
    assert holds(conditions, (0.5, 0.0)) == [1]
    assert isinstance(build_problem(plane(SQUARE, "s", conditions)).conditions[1], Neumann)


def test_a_condition_with_where_takes_its_piece_and_rest_the_other():
    conditions = [
        {"on": "rest", "neumann": 0},
        {"on": "s.top", "where": "x > 0.5", "dirichlet": 1},
        {"on": "s.left", "dirichlet": 0},
    ]
    assert holds(conditions, (0.7, 1.0)) == [1]
    assert holds(conditions, (0.3, 1.0)) == [0]
    assert holds(conditions, (0.0, 0.3)) == [2]
    assert holds(conditions, (0.3, 0.0)) == [0]


def test_pieces_that_exclude_each_other():
    conditions = [
        {"on": "s.top", "where": "x > 0.5", "dirichlet": 1},
        {"on": "s.top", "where": "x <= 0.5", "neumann": 1},
        {"on": "rest", "dirichlet": 0},
    ]
    assert holds(conditions, (0.7, 1.0)) == [0]
    assert holds(conditions, (0.3, 1.0)) == [1]
    assert holds(conditions, (1.0, 0.3)) == [2]


def test_two_pieces_of_one_surface_and_the_rest_between_them():
    disk = {"d": {"disk": {"center": [0, 0], "radius": 1}}}
    conditions = [
        {"on": "d", "where": "x > 0.5", "dirichlet": 1},
        {"on": "d", "where": "x < 0 - 0.5 and y > 0", "dirichlet": 2},
        {"on": "rest", "neumann": 0},
    ]
    angle = math.radians(140)
    assert holds(conditions, (1.0, 0.0), disk, "d") == [0]
    assert holds(conditions, (math.cos(angle), math.sin(angle)), disk, "d") == [1]
    assert holds(conditions, (math.cos(angle), -math.sin(angle)), disk, "d") == [2]
    assert holds(conditions, (0.0, 1.0), disk, "d") == [2]


U_SHAPE = {"u1": {"polygon": {"vertices": [[0, 0], [3, 0], [3, 2], [2, 2], [2, 1], [1, 1], [1, 2], [0, 2]]}}}


def test_collinear_edges_with_different_conditions():
    conditions = [
        {"on": "u1.edge2", "dirichlet": 1},
        {"on": "u1.edge6", "dirichlet": 2},
        {"on": "rest", "neumann": 0},
    ]
    assert holds(conditions, (2.5, 2.0), U_SHAPE, "u1") == [0]
    assert holds(conditions, (0.5, 2.0), U_SHAPE, "u1") == [1]
    assert holds(conditions, (1.5, 1.0), U_SHAPE, "u1") == [2]
    rest = build_problem(plane(U_SHAPE, "u1", conditions)).conditions[2].part
    assert rest.where is None
    assert len(rest.surfaces) == 6


def test_one_of_two_collinear_edges_without_a_condition():
    conditions = [{"on": [f"u1.edge{i}" for i in range(8) if i != 6], "dirichlet": 1}]
    with pytest.raises(CaseError, match=r"no condition on .* at \("):
        build_problem(plane(U_SHAPE, "u1", conditions))


def test_condition_on_everything_where():
    conditions = [{"on": "all", "where": "y > 0.5", "dirichlet": 1}, {"on": "rest", "neumann": 0}]
    assert holds(conditions, (0.0, 0.7)) == [0]
    assert holds(conditions, (0.0, 0.3)) == [1]
    assert holds(conditions, (0.5, 1.0)) == [0]
    assert holds(conditions, (0.5, 0.0)) == [1]


# Memory -------------------------------------------------------------------------------------------


def test_memory_grows_like_the_grid():
    case = load_case(BASE)
    domain = build_domain(case)
    sizes = [
        required_bytes(domain, build_discretization(case.discretized(degree=4, grid=n), domain))
        for n in (5000, 10000)
    ]
    assert sizes[1] / sizes[0] == pytest.approx(4, rel=0.1)
    assert grid_cells(domain, build_discretization(case, domain)) == (20, 20)


def test_too_large_a_grid_is_refused():
    case = load_case(BASE).discretized(degree=8, grid=100_000)
    domain = build_domain(case)
    with pytest.raises(DiscretizationError, match=r"TB of memory.*--allow-large"):
        require_memory(domain, build_discretization(case, domain))
    require_memory(domain, build_discretization(load_case(BASE), domain))
    assert available_bytes() > 0
    assert shown(1.5e9) == "1.5 GB"


def test_json_schema_knows_every_key():
    schema = Case.model_json_schema()
    assert set(schema["properties"]) == set(Case.model_fields)
    assert schema["additionalProperties"] is False
    assert set(schema["$defs"]["ShapeSpec"]["properties"]) >= set(KINDS)
    assert schema["$defs"]["Discretization"]["properties"]["degree"]["maximum"] == 40


# The documentation --------------------------------------------------------------------------------

DOCUMENT = Path(__file__).parents[2] / "docs" / "case-file.md"


def test_documentation_names_every_key_and_its_default():
    text = DOCUMENT.read_text()
    models = {
        Case,
        *MODELS.values(),
        ClampedEdge,
        SupportedEdge,
        FreeEdge,
        BoundaryCondition,
        Discretization,
        Solver,
        Study,
        Integral,
        ShapeSpec,
        AffineMap,
        Mirroring,
        Tapering,
        *KINDS.values(),
    }
    for model in models:
        for key in model.model_fields:
            assert f"`{key}" in text, f"{model.__name__}.{key}"
    for model in (Discretization, Solver):
        for key, field in model.model_fields.items():
            if field.default is not None:
                default = str(field.default).lower()
                assert f"| `{key}` | `{default}` |" in text, key
    for word in (*FUNCTIONS, *KINDS):
        assert word in text


def test_example_of_the_documentation_is_a_case():
    example = DOCUMENT.read_text().split("```yaml\n")[1].split("```")[0]
    case = case_from_document(from_text(example, "case-file.md"), {})
    assert build_problem(case).domain.parts == ("outer", "inner")


@pytest.mark.parametrize("number", [2, 3, 4, 5, 6])
def test_fragments_of_the_documentation_fit_a_case(number):
    fragment = DOCUMENT.read_text().split("```yaml\n")[number].split("```")[0]
    whole = {
        "rfm": 1,
        "geometry": {"shapes": {"plate": {"rectangle": {"min": [0, 0], "max": [2, 1]}}}, "domain": "plate"},
        "equation": {"poisson": {"source": 1}},
        "boundary_conditions": [{"on": "all", "dirichlet": 0}],
        "exact": "x",
    }
    build_problem(load_case(whole | from_text(fragment, "case-file.md").data))
