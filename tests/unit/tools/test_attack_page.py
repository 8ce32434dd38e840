"""The page of attacks says what was tried, what held and what did not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from attacks.page import TITLES, write_attack_page
from attacks.trials import Trial, failures, keep, rows

TRIALS = [
    Trial("bits", "seed 1", "refused", "state.h5: found a damaged one", True),
    Trial("bits", "seed 2", "KeyError", "'a|b'", False),
    Trial("cuts", "seed 3", "finished", "equal", True),
]
MADE = {"command": "python tools/attack.py x", "date": "2026-11-25", "commit": "1234abcd", "cpu_seconds": 61}


def record(kind: str) -> dict[str, Any]:
    if kind != "soak":
        return MADE | {"groups": rows(TRIALS), "failures": failures(TRIALS)}
    sample = {"steps": 500, "memory": 100.0, "files": 9, "cost": 1.25}
    grown = {"memory": 1.001, "files": 1.0, "cost": 0.99}
    run = {"run": "dry", "scene": "a.toml", "settings": ["time.end=1"], "samples": [sample] * 8, "growth": grown}
    return MADE | {"most": {"memory": 1.05}, "runs": [run | {"held": True}]}


def test_what_is_kept_is_shown(tmp_path: Path) -> None:
    for kind in TITLES:
        keep(kind, record(kind), tmp_path)
    page = write_attack_page(tmp_path, tmp_path / "attack.md").read_text(encoding="utf-8")
    assert "| Kills | 3 | 2 | `python tools/attack.py x` | 2026-11-25 | 1234abcd | 1 min |" in page
    assert "| bits | 2 | 1 | refused: 1 |" in page
    assert "| bits | `seed 2` | `KeyError: 'a\\|b'` |" in page
    assert "| 500 | 100 | 9 | 1.25 |" in page
