"""What can go wrong, by who can mend it.

Every error that a user can cause is an :class:`RfmError`; its message names the place and the
remedy.  The command maps the class to its exit code (2: the case or the command, 3: the numerics).
"""

from __future__ import annotations


class RfmError(Exception):
    """Base of all errors with a remedy in their message."""

    exit_code = 2


class GeometryError(RfmError):
    """A shape cannot be built or is not what the operation needs."""


class StructureError(RfmError):
    """Boundary conditions cannot be carried by one solution structure."""


class DiscretizationError(RfmError):
    """The grid, degree or basis does not suit the shape."""


class NumericsError(RfmError):
    """The numerics failed on a well-posed request (not converged, not finite, incompatible data)."""

    exit_code = 3


class CaseError(RfmError):
    """A case file or an override is wrong.

    Parameters
    ----------
    message
        What is wrong and what to do about it.
    path
        Dotted path of the key, e.g. ``geometry.shapes.inner.disk.radius``.
    place
        ``file:line:column`` or ``--set`` when the value came from the command line.
    excerpt
        Lines of the file with a caret below the column, or empty.
    """

    def __init__(self, message: str, *, path: str = "", place: str = "", excerpt: str = "") -> None:
        self.message, self.path, self.place, self.excerpt = message, path, place, excerpt
        super().__init__(message)

    def __str__(self) -> str:
        head = ": ".join(part for part in (self.place, self.path, self.message) if part)
        return f"{head}\n{self.excerpt}" if self.excerpt else head


class DataError(RfmError):
    """A datum of the problem (source, conductivity, boundary value, ...) is not finite where it is needed.

    Attributes
    ----------
    name : str
        What the datum is, e.g. ``source``.
    field : object
        The field itself, so that an application can find where the user wrote it.
    point : tuple of float
        The first point at which the value is not finite.
    """

    def __init__(self, name: str, field: object, point: tuple[float, ...], value: float) -> None:
        self.name, self.field, self.point = name, field, point
        where = ", ".join(f"{axis} = {c:.6g}" for axis, c in zip("xyz", point, strict=False))
        super().__init__(
            f"the {name} is {value} at {where}; it must be finite on the whole domain "
            "(guard it with where(condition, a, b), or cut the point out of the domain)"
        )
