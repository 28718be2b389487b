"""What all kinds of shape share in a case: their arguments are those of a constructor."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from rfm.app.schema.base import Strict


class Kind(Strict):
    """Arguments of one kind of shape.

    Attributes
    ----------
    dimension
        1, 2 or 3; 0 for a kind of dimension 2 or 3.
    """

    dimension: ClassVar[int] = 0

    def arguments(self) -> dict[str, Any]:
        """Arguments for the constructor: those that were given, angles in radians."""
        given = {
            name: getattr(self, name) for name in type(self).model_fields if name in self.model_fields_set
        }
        return {name: math.radians(v) if name == "angle" else v for name, v in given.items() if v is not None}
