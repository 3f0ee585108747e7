"""The one exception of this package."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def told(what: str) -> Iterator[None]:
    """Makes what the system says of files the one exception."""
    try:
        yield
    except (OSError, shutil.Error, UnicodeError) as cause:
        raise Error(f"{what}: cannot be read or written ({cause})") from cause


class Error(ValueError):
    """A scene, problem, result or argument is wrong, or there is no answer; nothing was written.

    `path` is the path of the wrong entry, such as `muscles[1].from.body` (empty where there is none), `excerpt` the lines of the
    text around it, with the place marked.
    """

    path: str
    excerpt: str

    def __init__(self, message: str, path: str = "", excerpt: str = "") -> None:
        super().__init__(message)
        self.path = path
        self.excerpt = excerpt

    def __str__(self) -> str:
        message: str = self.args[0]
        return f"{message}\n{self.excerpt}" if self.excerpt else message
