"""Tetrahedra inside of a result's closed surfaces, made by another program."""

from ._filled import MESHERS, Filled, check_target, fill

__all__ = ["MESHERS", "Filled", "check_target", "fill"]
