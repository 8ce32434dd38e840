"""The page of all attacks, from what is kept of them."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from attacks.trials import KEPT

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "validation" / "attack.md"


def write_attack_page() -> Path:
    """Write it; returns its file."""
    return PAGE
