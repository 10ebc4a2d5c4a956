"""Results that are a number where one is asked for."""

from __future__ import annotations

from typing import Any, SupportsFloat


class Number:
    """Arithmetic, order and formatting of the number that ``float`` gives."""

    def __float__(self) -> float:
        raise NotImplementedError

    def __add__(self, other: SupportsFloat) -> float:
        return float(self) + float(other)

    def __radd__(self, other: SupportsFloat) -> float:
        return float(other) + float(self)

    def __sub__(self, other: SupportsFloat) -> float:
        return float(self) - float(other)

    def __rsub__(self, other: SupportsFloat) -> float:
        return float(other) - float(self)

    def __mul__(self, other: SupportsFloat) -> float:
        return float(self) * float(other)

    def __rmul__(self, other: SupportsFloat) -> float:
        return float(other) * float(self)

    def __truediv__(self, other: SupportsFloat) -> float:
        return float(self) / float(other)

    def __rtruediv__(self, other: SupportsFloat) -> float:
        return float(other) / float(self)

    def __pow__(self, other: SupportsFloat) -> Any:
        return float(self) ** float(other)

    def __neg__(self) -> float:
        return -float(self)

    def __abs__(self) -> float:
        return abs(float(self))

    def __lt__(self, other: SupportsFloat) -> bool:
        return float(self) < float(other)

    def __le__(self, other: SupportsFloat) -> bool:
        return float(self) <= float(other)

    def __gt__(self, other: SupportsFloat) -> bool:
        return float(self) > float(other)

    def __ge__(self, other: SupportsFloat) -> bool:
        return float(self) >= float(other)

    def __eq__(self, other: object) -> bool:
        """To a number by value, to one of its own kind by all fields."""
        if isinstance(other, (int, float)):
            return float(self) == other
        return super().__eq__(other)

    def __hash__(self) -> int:
        return hash(float(self))

    def __format__(self, spec: str) -> str:
        return format(float(self), spec) if spec else str(self)
