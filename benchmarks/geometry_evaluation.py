"""How fast shapes are evaluated: value and gradient at a million points, on the default NumPy path.

    python benchmarks/geometry_evaluation.py [points]

Wall time is the smallest of three; the processor time beside it does not depend on what else the machine does.
The inside test is compared with matplotlib's, and with shapely's where it is installed.
"""

from __future__ import annotations

import importlib.util
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import rfm.geometry as g
from rfm.calculus import R0
from rfm.calculus.types import Array
from rfm.geometry.sampled import sample
from rfm.geometry.vanishing import Composition

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "geometry"))
from random_polygons import random_polygon
from test_sampled import random_solid

VERTICES, OPERATIONS = 200, 40


def timed(work: Callable[[], object]) -> tuple[float, float]:
    """Smallest wall and processor time of three runs."""
    wall, processor = [], []
    for _ in range(3):
        start, busy = time.perf_counter(), time.process_time()
        work()
        wall.append(time.perf_counter() - start)
        processor.append(time.process_time() - busy)
    return min(wall), min(processor)


def r0(shape: g.Shape) -> Composition:
    """Make the R0-function of a shape."""
    return Composition(shape.expression, R0, lambda surface: surface.function)


def inside_tests(vertices: Array, points: Array) -> dict[str, Callable[[], Array]]:
    """Inside tests of other programs."""
    from matplotlib.path import Path as Outline

    tests: dict[str, Callable[[], Array]] = {
        "matplotlib.path.contains_points": lambda: Outline(vertices).contains_points(points)
    }
    if importlib.util.find_spec("shapely"):
        import shapely

        outline = shapely.Polygon(vertices)
        shapely.prepare(outline)
        tests["shapely.contains_xy (prepared)"] = lambda: shapely.contains_xy(outline, *points.T)
    return tests


def main() -> None:
    """Print the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    random = np.random.default_rng(0)
    vertices = random_polygon(VERTICES, random)
    polygon, solid = g.polygon(vertices), random_solid(OPERATIONS, random)
    flat, space = random.uniform(0, 1, (count, 2)), random.uniform(-1.2, 1.2, (count, 3))
    print(f"{count} points; wall and processor time in seconds\n")
    for title, shape, points in (
        (f"polygon of {VERTICES} vertices", polygon, flat),
        (f"solid of {OPERATIONS} operations ({len(solid.surfaces)} surfaces)", solid, space),
    ):
        print(title)
        for kind, field in (("membership (min/max)", shape.membership), ("R0-function", r0(shape))):
            for order, what in ((1, "value and gradient"), (0, "value")):
                wall, busy = timed(
                    lambda field=field, points=points, order=order: sample(field, points, order)
                )
                print(f"  {kind:24s}{what:22s}{wall:8.2f}{busy:8.2f}")
    print("inside tests of the polygon")
    ours = sample(polygon, flat, 0)[0] > 0.0
    wall, busy = timed(lambda: sample(polygon, flat, 0)[0] > 0.0)
    print(f"  {'sample(...) > 0':46s}{wall:8.2f}{busy:8.2f}")
    for name, test in inside_tests(vertices, flat).items():
        differing = int((test() != ours).sum())
        wall, busy = timed(test)
        print(f"  {name:46s}{wall:8.2f}{busy:8.2f}  {differing} answers differ")


if __name__ == "__main__":
    main()
