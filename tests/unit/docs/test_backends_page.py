"""The page of backends tells what each offers, as its class does."""

from __future__ import annotations

from typing import Any

import pytest
from paths import ROOT

from rigidfluid.backends.dolfinx import Dolfinx
from rigidfluid.backends.dry import Dry
from rigidfluid.backends.scikit_fem import ScikitFem

OFFERS = {
    "[periodic surfaces]": ("periodic_faces",),
    "[`flux`]": ("held_fluxes",),
    "across no axis": ("oblique_faces",),
    "`output.stresslets`": ("stresslets", "boundary_forces"),
    "[bodies that enter or leave]": ("exchanges_bodies",),
    "`mesh.accuracy`": ("cell_errors", "tangents"),
}


@pytest.mark.parametrize(("column", "backend"), [(1, ScikitFem), (2, Dolfinx), (3, Dry)])
def test_the_table_tells_what_the_class_offers(column: int, backend: Any) -> None:
    page = (ROOT / "docs" / "backends.md").read_text(encoding="utf-8").partition("## What each offers")[2]
    rows = [line.strip("|").split("|") for line in page.splitlines() if line.startswith("|")]
    for words, keys in OFFERS.items():
        (row,) = (row for row in rows if words in row[0])
        told = row[column].strip()
        assert told in ("yes", "no", "")
        assert {getattr(backend, key) for key in keys} == {told == "yes"}, words
