from collections.abc import Callable
from typing import Any, TypeVar

types: Any

_F = TypeVar("_F", bound=Callable[..., object])

def njit(
    *, cache: bool = ..., fastmath: bool | set[str] = ..., error_model: str = ..., inline: str = ..., nogil: bool = ...
) -> Callable[[_F], _F]: ...
