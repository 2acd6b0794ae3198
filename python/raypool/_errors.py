"""What raypool raises."""

from __future__ import annotations

from typing import Any


class InputError(ValueError):
    """A scene or an option was refused; nothing was rendered. The text says what the command would say.

    place -- the JSON pointer of the value in the scene (``/materials/red/fuzz``), ``line:column`` in a text that is no
             JSON, or the command's name of the option (``--spp``); None where there is none.
    """

    def __init__(self, message: str, place: str | None = None) -> None:
        super().__init__(message)
        self.place = place

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.place)


class ImagesDiffer(RuntimeError):
    """compare() found renders that are not the same image.

    hashes -- by engine, those of all its runs.
    """

    def __init__(self, hashes: dict[str, set[str]]) -> None:
        named = "; ".join(f"{engine}: {', '.join(sorted(found))}" for engine, found in hashes.items())
        super().__init__(f"the images differ: {named}")
        self.hashes = hashes

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.hashes,)
