"""What the library's results hold, as objects with attributes."""

from __future__ import annotations

import html
from typing import Any, Iterator


class Record(dict):  # type: ignore[type-arg]
    """A dict whose keys are attributes too: `record.after.rms`."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(
                f"no {name!r} here, expected one of {', '.join(self)}"
            ) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        return "Record(" + ", ".join(
            f"{key}={_brief(value)}" for key, value in self.items()) + ")"


def _brief(value: Any) -> str:
    if isinstance(value, Record):
        return "Record(...)"
    if isinstance(value, list) and len(value) > 3:
        return f"[{len(value)} items]"
    return repr(value)


def records(value: Any) -> Any:
    """Maps as records, to any depth."""
    if isinstance(value, dict):
        return Record((key, records(item)) for key, item in value.items())
    if isinstance(value, list):
        return [records(item) for item in value]
    return value


def record(value: dict[str, Any]) -> Record:
    return Record((key, records(item)) for key, item in value.items())


class Svg:
    """A figure: notebooks show it, `save` writes it."""

    def __init__(self, name: str, title: str, svg: str, note: str = "") -> None:
        self.name = name
        self.title = title
        self.svg = svg
        self.note = note

    def _repr_html_(self) -> str:
        return (f"<figure style='margin:0'><figcaption>"
                f"<b>{html.escape(self.title)}</b> {html.escape(self.note)}"
                f"</figcaption>{self.svg}</figure>")

    def __repr__(self) -> str:
        return f"Svg({self.name!r}, {self.title!r})"

    def save(self, path: Any) -> None:
        """As a file of its own."""
        svg = self.svg
        if "xmlns=" not in svg.split(">", 1)[0]:
            svg = svg.replace("<svg", '<svg xmlns="http://www.w3.org/2000/svg"',
                              1)
        with open(path, "w", encoding="utf-8") as file:
            file.write(svg)


class Figures(dict):  # type: ignore[type-arg]
    """Figures by name; a notebook shows all of them."""

    def _repr_html_(self) -> str:
        return "".join(figure._repr_html_() for figure in self.values())

    def __getattr__(self, name: str) -> Svg:
        try:
            figure: Svg = self[name]
        except KeyError:
            raise AttributeError(f"no figure {name!r}, expected one of "
                                 f"{', '.join(self)}") from None
        return figure

    def __iter__(self) -> Iterator[str]:
        return super().__iter__()
