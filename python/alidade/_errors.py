"""What goes wrong: wrong input, and calibrations that come to no result."""

from __future__ import annotations

from typing import Any


class InputError(ValueError):
    """A file, an argument or an option is wrong, and the caller can mend it.

    The message says what was found, what was expected and what to do.
    Attributes: `message` without its place; `file`, `line` and `column` (from
    1; empty or 0 where there are none); `key`, the argument, option or column
    that is wrong.
    """

    def __init__(self, message: str, file: str = "", line: int = 0,
                 column: int = 0, key: str = "") -> None:
        self.message = message
        self.file = file
        self.line = line
        self.column = column
        self.key = key
        super().__init__(message, file, line, column, key)

    @property
    def remedy(self) -> str:
        """What to do, as far as the message says it: from "expected" on."""
        start = self.message.find("expected")
        return self.message[start:] if start >= 0 else ""

    def __str__(self) -> str:
        place = self.file
        for number in (self.line, self.column):
            if place and number:
                place += f":{number}"
        return ": ".join(part for part in (place, self.key, self.message)
                         if part)


class CalibrationError(RuntimeError):
    """A calibration, plan or study came to no usable result.

    `result` is as complete as it got, `None` where there is nothing.
    """

    def __init__(self, message: str, result: Any = None) -> None:
        super().__init__(message)
        self.result = result


def wrong(argument: str, message: str) -> InputError:
    return InputError(message, key=argument)
