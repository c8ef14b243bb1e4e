"""Files of a package, and its page with the blanks filled."""

from __future__ import annotations

import re
from importlib import resources
from typing import Dict


def text_of(package: str, name: str) -> str:
    return (resources.files(package) / name).read_text(encoding="utf-8")


def filled(package: str, blanks: Dict[str, str]) -> str:
    """page.html of the package with each {{blank}} replaced."""
    return re.sub(r"\{\{(\w+)\}\}", lambda blank: blanks[blank[1]], text_of(package, "page.html"))
