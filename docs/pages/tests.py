"""The validation tests: how many pass, and which fail."""

from __future__ import annotations

from page_tools import Page, Work, table
from page_tools.kept_tests import Found, files_of_tests
from page_tools.places import ROOT

HEAD = ("file", "passed", "failed", "skipped", "commit", "CPU s")


def page(work: Work) -> Page:
    """A row for each file, and the names of tests that fail."""
    found = {str(path.relative_to(ROOT)): work.tests(path) for path in files_of_tests()}
    rows = [(f"`{name}`", *counts(one), one.commit, f"{one.cpu_seconds:.0f}") for name, one in found.items()]
    whole = [sum(len(getattr(one, outcome)) for one in found.values()) for outcome in ("passed", "failed", "skipped")]
    failed = [f"* `{name}`: `{test}`" for name, one in found.items() for test in one.failed]
    text = ABOUT.format(
        passed=whole[0], failed=whole[1], skipped=whole[2], table=table(HEAD, rows), names="\n".join(failed) or "None."
    )
    return Page("Validation tests", text)


def counts(found: Found) -> tuple[str, str, str]:
    """How many tests passed, failed and were skipped."""
    return str(len(found.passed)), str(len(found.failed)), str(len(found.skipped))


ABOUT = """Tests marked `validation`, against published figures or at length: {passed} passed, {failed} failed and
{skipped} were skipped. A file is run again where it or the sources are others.

{table}

## Failed

{names}"""
