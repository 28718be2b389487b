"""From pydantic's complaints to errors with a place, a plain sentence and a remedy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import UnionType
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from rfm.app.schema.base import Strict
from rfm.app.schema.scalars import Scope, shown
from rfm.app.source import Document, nearest
from rfm.app.yaml_reader import Path
from rfm.errors import CaseError

Model = TypeVar("Model", bound=Strict)


def validate(model: type[Model], document: Document, scope: Scope) -> tuple[Model | None, list[CaseError]]:
    """Return the model of the data of a document, or None and the errors."""
    try:
        return model.model_validate(document.data, context=scope), []
    except ValidationError as error:
        found: list[dict[str, Any]] = [
            dict(item) for item in error.errors(include_url=False, include_input=False)
        ]
        # a key that is unknown is probably the one that is missing
        mistyped = {item["loc"][:-1] for item in found if item["type"] == "extra_forbidden"}
        told = [item for item in found if item["type"] != "missing" or item["loc"][:-1] not in mistyped]
        return None, [_translate(model, document, item) for item in told]


def _translate(model: type[BaseModel], document: Document, item: dict[str, Any]) -> CaseError:
    rule = _RULES.get(str(item["type"]), _other)
    return rule(model, document, item)


def _own(model: type[BaseModel], document: Document, item: dict[str, Any]) -> CaseError:
    context = item["ctx"]
    path = existing(document.data, (*existing(document.data, item["loc"]), *(context["inner"] or ())))
    return document.error(path, context["message"], offset=context["offset"], key=context["at_key"])


def _missing(model: type[BaseModel], document: Document, item: dict[str, Any]) -> CaseError:
    path = existing(document.data, item["loc"][:-1])
    return document.error(path, f"the key {item['loc'][-1]!r} is missing", key=True)


def _unknown(model: type[BaseModel], document: Document, item: dict[str, Any]) -> CaseError:
    path, name = tuple(item["loc"]), str(item["loc"][-1])
    owner = annotation_at(model, path[:-1])
    if not (isinstance(owner, type) and issubclass(owner, Strict)):
        return document.error(path, f"unknown key {name!r}", key=True)
    if name in owner.refused:
        return document.error(path, owner.refused[name], key=True)
    message = f"unknown key {name!r}; {nearest(name, owner.model_fields)}"
    return document.error(path, message, key=True)


def _not_a_mapping(model: type[BaseModel], document: Document, item: dict[str, Any]) -> CaseError:
    path = existing(document.data, item["loc"])
    owner = annotation_at(model, tuple(item["loc"]))
    keys = ""
    if isinstance(owner, type) and issubclass(owner, BaseModel):
        keys = f" with the keys {', '.join(owner.model_fields)}"
    return document.error(path, f"must be a mapping{keys}, got {shown(_value(document.data, path))}")


def _not_a_list(model: type[BaseModel], document: Document, item: dict[str, Any]) -> CaseError:
    path = existing(document.data, item["loc"])
    return document.error(path, f"must be a list, got {shown(_value(document.data, path))}")


def _other(model: type[BaseModel], document: Document, item: dict[str, Any]) -> CaseError:
    return document.error(existing(document.data, item["loc"]), str(item["msg"]))


_RULES: Mapping[str, Callable[[type[BaseModel], Document, dict[str, Any]], CaseError]] = {
    "case": _own,
    "missing": _missing,
    "extra_forbidden": _unknown,
    "model_type": _not_a_mapping,
    "model_attributes_type": _not_a_mapping,
    "dict_type": _not_a_mapping,
    "list_type": _not_a_list,
    "tuple_type": _not_a_list,
}


def existing(data: Any, location: tuple[str | int, ...]) -> Path:
    """Beginning of a location that exists in the data."""
    path: list[str | int] = []
    for part in location:
        if isinstance(data, dict) and part in data:
            data = data[part]
        elif isinstance(data, list) and str(part).isdigit() and int(part) < len(data):
            part = int(part)
            data = data[part]
        else:
            break
        path.append(part)
    return tuple(path)


def annotation_at(model: type[BaseModel], location: tuple[str | int, ...]) -> Any:
    """Type that the schema has at a location; None where it has none."""
    annotation: Any = model
    for part in location:
        annotation = _plain(annotation)
        arguments = get_args(annotation)
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            known = annotation.model_fields.get(str(part))
            annotation = known.annotation if known else None
        elif arguments:
            annotation = arguments[1] if get_origin(annotation) is dict else arguments[0]
        else:
            return None
    return _plain(annotation)


def _plain(annotation: Any) -> Any:
    """Type without ``Annotated`` and ``| None``."""
    while get_origin(annotation) in (Annotated, Union, UnionType):
        arguments = [argument for argument in get_args(annotation) if argument is not type(None)]
        annotation = arguments[0]
    return annotation


def _value(data: Any, path: Path) -> Any:
    for part in path:
        data = data[part]
    return data
