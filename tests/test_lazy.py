"""Names and values that are imported on first use."""

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

import pytest

import rfm.geometry
import solvers.quadrature
from rfm.geometry.derived import DERIVED
from rfm.geometry.primitives import KINDS
from rfm.lazy import Registry, attributes
from solvers.bases.registry import BASES
from solvers.methods import METHODS


@pytest.mark.parametrize("package", [rfm.geometry, solvers.quadrature], ids=lambda package: package.__name__)
def test_every_public_name_is_there_and_no_submodule_shadows_it(package):
    for found in iter_modules(package.__path__):
        import_module(f"{package.__name__}.{found.name}")
    for name in package.__all__:
        assert not isinstance(getattr(package, name), ModuleType), name


@pytest.mark.parametrize("registry", [KINDS, DERIVED, BASES, METHODS])
def test_every_value_of_a_registry_is_found_under_its_name(registry):
    assert len(registry) == len(list(registry)) > 3
    for name, value in registry.items():
        assert getattr(value, "name", None) == name or value.__name__ == name
        assert registry[name] is value


def test_unknown_names():
    with pytest.raises(AttributeError, match="module 'here' has no attribute 'b'"):
        attributes("here", {"math": ("pi",)})("b")
    assert attributes("here", {"math": ("pi",)})("pi") == pytest.approx(3.14159, abs=1e-5)
    registry = Registry({"pi": "math:pi"})
    assert "tau" not in registry
    with pytest.raises(KeyError, match="tau"):
        registry["tau"]
