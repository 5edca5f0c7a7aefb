"""Exceptions by kind."""

from collections.abc import Iterable
from typing import NamedTuple


class Mistake(NamedTuple):
    """A mistake in a file; ``line`` and ``column`` count from 1, and are None where it stands at no place."""

    line: int | None
    column: int | None
    message: str


class Error(Exception):
    """Whatever Hamel refuses."""


class FileError(Error):
    """A scene or a robot that cannot be read. The text of the exception shows each mistake under its line.

    Attributes:
        source: the file, or ``text``.
        mistakes: all of them, in the order of the file.
    """

    def __init__(
        self, message: str = "", *, source: str = "", mistakes: Iterable[tuple[int | None, int | None, str]] = ()
    ) -> None:
        super().__init__(message)
        self.source = source
        self.mistakes = [Mistake(*mistake) for mistake in mistakes]


class ArgumentError(Error, ValueError):
    """An argument of the wrong shape, a number that is not finite, an unknown name, an option out of range.

    Attributes:
        index: of the state in a batch, a tuple; None where it is of no state.
    """

    def __init__(self, message: str = "", *, index: tuple[int, ...] | None = None) -> None:
        super().__init__(message)
        self.index = index


class DynamicsError(Error):
    """Equations of motion without a solution at a state, as where the mass matrix is singular.

    Attributes:
        index: of the state in a batch, a tuple; None where it is of no batch.
    """

    def __init__(self, message: str = "", *, index: tuple[int, ...] | None = None) -> None:
        super().__init__(message)
        self.index = index


class CompilationError(Error):
    """Equations of motion that cannot be compiled: the machine has no C compiler, or the scene has something of which the scene compiler does not write equations."""


class IntegrationError(Error):
    """A motion that does not go on, or whose accuracy is not reached.

    Attributes:
        time: reached, s; None where it is of no time.
    """

    def __init__(self, message: str = "", *, time: float | None = None) -> None:
        super().__init__(message)
        self.time = time
