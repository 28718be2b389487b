"""What all models of the schema share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from pydantic import BaseModel, ConfigDict

from rfm.app.schema.scalars import fail


class Strict(BaseModel):
    """Mapping that accepts its own keys and nothing else.

    Attributes
    ----------
    refused
        Keys that are known but not built, with the sentence that refuses them.
    """

    model_config = ConfigDict(
        extra="forbid", frozen=True, arbitrary_types_allowed=True, validate_default=False, defer_build=True
    )

    refused: ClassVar[Mapping[str, str]] = {}

    def one_of(self, names: tuple[str, ...], what: str) -> str:
        """Name of the only key among `names` that was given.

        Raises
        ------
        PydanticCustomError
            None or several were given.
        """
        given = [name for name in names if name in self.model_fields_set]
        if len(given) == 1 and getattr(self, given[0]) is not None:
            return given[0]
        listed = ", ".join(names)
        if len(given) == 1:
            raise fail(f"needs a value for {given[0]}", key=(given[0],))
        if not given:
            raise fail(f"needs {what}, one of: {listed}")
        raise fail(f"has {' and '.join(given)}; {what} is only one of them", key=(given[1],))
