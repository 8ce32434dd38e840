"""The site that `make docs` has built opens in a browser: pages, pictures and the search."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from paths import ROOT

SITE = ROOT / "site"
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
OPENED = ["index", "tutorial/1-first-scene", "gallery", "validation", "api/running", "scene"]

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not (SITE / "index.html").exists(), reason="the site is not built: make docs"),
]


def opened(address: str) -> tuple[str, str]:
    """Document of a page after its scripts have run, and what the browser complained of."""
    assert BROWSER is not None
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--virtual-time-budget=20000"]
    command = [BROWSER, *options, "--dump-dom", f"{SITE.as_uri()}/{address}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240, check=True)
    return done.stdout, "\n".join(line for line in done.stderr.splitlines() if "CONSOLE" in line)


@pytest.mark.parametrize("page", sorted(SITE.glob("**/*.html")), ids=lambda page: str(page.relative_to(SITE)))
def test_pictures_and_links_of_a_page_are_files_of_the_site(page: Path) -> None:
    """Sphinx checks those that it makes; this holds those of themes and of raw HTML too."""
    named = re.findall(r'(?:src|href)="([^"#?]+)', page.read_text(encoding="utf-8"))
    local = [name for name in named if not re.match(r"[a-z]+:|//", name)]
    assert [name for name in local if not (page.parent / name).exists()] == []


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
@pytest.mark.parametrize("page", OPENED)
def test_a_page_opens_in_a_browser(page: str) -> None:
    document, complaints = opened(f"{page}.html")
    assert "<h1>" in document
    assert not complaints


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_the_search_finds_a_law() -> None:
    """Without a server it has no excerpts, of which the browser complains."""
    document, _ = opened("search.html?q=barrier")
    assert 'href="forces.html' in document.partition('id="search-results"')[2]
