"""How calls end that take long: with an answer, or with an exception that has the result so far."""

from __future__ import annotations

import atexit
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from proboscis import _proboscis

_Answer = TypeVar("_Answer")

_left: set[Interrupted] = set()
"""Calls that were left to end behind the back of their callers."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C has ended a call at once; what it does ends in good order a little later, and writes its files."""

    def __init__(self, read: Callable[[], object], left: _proboscis.Ending | None, keeps: bool) -> None:
        super().__init__()
        self._read: Callable[[], object] | None = read
        self._found: object = None
        self._left = left
        # Whether its files are to stay when Python ends.
        self._keeps = keeps
        if left is not None:
            _left.add(self)

    @property
    def result(self) -> Any:
        """The result so far, as the call would have returned it, or None where there is none yet; it is waited for."""
        if self._read is not None:
            self._found = self._read()
            self._read = None
            _left.discard(self)
        return self._found

    __hash__ = KeyboardInterrupt.__hash__


def ended(
    outcome: _proboscis.Outcome,
    read: Callable[[tuple[bool, str, list[str]]], _Answer],
    *,
    keeps: bool = False,
) -> _Answer:
    """Returns what `read` makes of what a call tells, or raises what ended it early; `keeps` says that it writes files that stay."""
    forget()
    told, raised, left = outcome
    if raised is None:
        assert told is not None, "a call without an exception tells something"
        return read(told)
    if isinstance(raised, KeyboardInterrupt):

        def later() -> object:
            late = told if left is None else left.wait()
            return None if late is None else read(late)

        raise Interrupted(later, left, keeps) from None
    raised.result = None if told is None else read(told)  # type: ignore[attr-defined]
    raise raised


def forget() -> None:
    """Forgets calls that have ended meanwhile."""
    for one in [one for one in _left if one._left is None or one._left.is_over()]:
        _left.discard(one)


@atexit.register
def _wait() -> None:
    """Lets calls write the files that are to stay."""
    for one in list(_left):
        if one._keeps and one._left is not None:
            one._left.wait()
