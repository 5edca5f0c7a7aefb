"""Levels of instructions.

Mathematical functions are those of the C library, which has versions of them with and without fused products and chooses by the processor: last bits of motions depend on which.
"""

from __future__ import annotations

from . import _hamel
from ._errors import ArgumentError

# What a process must have in its environment when it starts, by level; the lowest level first. Where processors have one level there is nothing to choose.
LEVELS: dict[str, dict[str, str]] = {level: dict([hidden] if hidden else []) for level, hidden in _hamel.levels()}


def check_level(level: str | None) -> None:
    """Refuses a level that is not that of this process."""
    own, _ = _hamel.arithmetic()
    if level in (None, own):
        return
    needed = " ".join(f"{name}={value}" for name, value in LEVELS[str(level)].items())
    how = f"start Python with {needed} in its environment" if needed else "this machine does not have it, or its environment hides it"
    raise ArgumentError(f"level is {level!r}, and this process computes at {own!r}: {how}")


def lowest(levels: set[str]) -> str | None:
    """The lowest of the levels; None where they are of different processors."""
    if len(levels) == 1:
        return next(iter(levels))
    return next((level for level in LEVELS if level in levels), None) if levels <= LEVELS.keys() else None
