"""Tetrahedra inside of a result's closed surfaces, made by another program."""

from ._filled import Filled, check_target, fill

__all__ = ["Filled", "check_target", "fill"]
