"""Options as keywords. What they are is described once, beside the structs of
the library (`_core.options_of`): names, meanings, ranges and words come from
there, and so do messages."""

from __future__ import annotations

import difflib
import inspect
import json
import math
from functools import lru_cache
from typing import Any, Callable, Mapping, TypeVar

import numpy as np

from . import _core
from ._errors import InputError, wrong

Option = Mapping[str, Any]
_Function = TypeVar("_Function", bound=Callable[..., Any])


def flow(value: Any, argument: str) -> str:
    """A value as YAML in one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(
            f"{json.dumps(str(key))}: {flow(item, f'{argument}.{key}')}"
            for key, item in value.items()) + "}"
    if hasattr(value, "tolist") and not isinstance(value, (str, bytes)):
        value = value.tolist()  # NumPy and pandas
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(flow(item, argument) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, float):
        if math.isnan(value):
            return ".nan"
        return repr(value) if math.isfinite(value) else (
            ".inf" if value > 0 else "-.inf")
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    raise wrong(argument, f"found {type(value).__name__} {value!r:.60}, "
                "expected a number, a text, a list or a map")


@lru_cache(maxsize=None)
def options_of(command: str) -> tuple[Option, ...]:
    """The options of "calibrate", "plan" or "montecarlo"."""
    return tuple(_core.options_of(command))


@lru_cache(maxsize=None)
def _places(command: str) -> dict[str, tuple[str, ...]]:
    """Where each keyword stands: sections by their names, and what is in them
    by its own where that is no name of two."""
    places: dict[str, tuple[str, ...]] = {}
    repeated = set()
    for option in options_of(command):
        places[option["name"]] = (option["name"],)
    for option in options_of(command):
        if option["type"] != "section":
            continue
        for field in option["fields"]:
            name = field["name"]
            if name in places:
                repeated.add(name)
            places.setdefault(name, (option["name"], name))
    for name in repeated:
        if len(places[name]) > 1:
            del places[name]
    return places


def nested(command: str, keywords: Mapping[str, Any]) -> dict[str, Any]:
    """Keywords as sections. None stands for what is not said."""
    places = _places(command)
    sections: dict[str, Any] = {}
    for name, value in keywords.items():
        if value is None:
            continue
        place = places.get(name)
        if place is None:
            near = difflib.get_close_matches(name, places, 1)
            did = f", did you mean \"{near[0]}\"" if near else ""
            raise wrong(name, f"unknown option{did}? Expected one of "
                        + ", ".join(sorted(places)))
        if len(place) == 1:
            if isinstance(value, Mapping) and isinstance(
                    sections.get(name), dict):
                sections[name].update(value)
            else:
                sections[name] = (dict(value) if isinstance(value, Mapping)
                                  else value)
        else:
            section = sections.setdefault(place[0], {})
            if not isinstance(section, dict):
                raise wrong(place[0], f"found {section!r:.60} beside {name}, "
                            "expected a dict")
            section[name] = value
    return sections


def text_of(command: str, keywords: Mapping[str, Any]) -> str:
    sections = nested(command, keywords)
    return ('{"units": {"length": "m", "angle": "rad"}, "options": '
            + flow(sections, command) + "}")


def without_place(error: InputError) -> InputError:
    """Of a text that no user has written, the option alone."""
    if error.file != "options":
        return error
    key = error.key
    if key.startswith("options"):
        key = key[len("options"):].lstrip(".")
    return InputError(error.message, key=key)


class reading:
    """Errors of options are those of the keywords, and units are factors."""

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        if not isinstance(error, InputError):
            return
        if error.file == "options":
            raise without_place(error) from None
        for unit in ("mm", "deg"):
            if error.message.endswith(f"state the unit {unit}"):
                raise InputError(f"{error.message}: multiply by alidade.{unit}",
                                 error.file, error.line, error.column,
                                 error.key or "data") from None


def _line(option: Option, indent: str) -> list[str]:
    unit = {"length": "m", "angle": "rad"}.get(option["unit"], option["unit"])
    facts = [part for part in (
        " | ".join(option["words"]) or option["type"], unit, option["range"],
        "required" if option["required"] else "",
        f"default {option['default']}" if option["default"] else "") if part]
    lines = [f"{indent}{option['name']} : {', '.join(facts)}"]
    words = option["text"].split()
    line = indent + "   "
    for word in words:
        if len(line) + len(word) > 78:
            lines.append(line)
            line = indent + "   "
        line += " " + word
    lines.append(line)
    for field in option["fields"]:
        lines += _line(field, indent + "    ")
    return lines


def with_options(text: str | None, command: str) -> str:
    """A docstring with all options of a command for its {options}. Python keeps
    the indentation of docstrings before 3.13, and none since: none is here."""
    lines = []
    for option in options_of(command):
        lines += _line(option, "")
    return inspect.cleandoc(text or "").replace("{options}", "\n".join(lines))


def takes_options(command: str,
                  documented: str = "") -> Callable[[_Function], _Function]:
    """Completes docstring and signature of a function with **options. Its text
    lists those of `documented`, where these are others."""

    def complete(function: _Function) -> _Function:
        function.__doc__ = with_options(function.__doc__,
                                        documented or command)
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values()
               if p.kind is not inspect.Parameter.VAR_KEYWORD]
        names = {p.name for p in own}
        added = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY,
                                   default=None)
                 for name in _places(command) if name not in names]
        setattr(function, "__signature__",
                signature.replace(parameters=own + added))
        return function

    return complete
