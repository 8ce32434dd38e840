"""Code blocks of a page, which are files to be written, or commands and programs to be run, in one folder."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import rigidfluid

RUN = frozenset({"sh", "python"})
"""Languages of blocks that are run, unless the paragraph before names a file."""
SHOWN = frozenset({"console", "text", "{toctree}", "{image}", "{eval-rst}"})
"""Languages of blocks that are neither run nor written: what needs a system's packages, a cluster or a window."""

_FENCE = re.compile(r"(?P<before>[^\n]*)\n\n?```(?P<language>[^\n]*)\n(?P<text>.*?)\n```", re.DOTALL)
_FILE = re.compile(r"Save this as `(?P<saved>[\w./-]+)`|`(?P<named>[\w./-]+)`:$")


@dataclass(frozen=True)
class Block:
    """One block of a page: its ``language``, its ``text``, and the ``file`` that it is, if it is one."""

    language: str
    text: str
    file: str | None

    def needs(self, package: str) -> bool:
        """Whether the block, or the file of a page that it runs, imports a package."""
        return re.search(rf"^(import|from) {package}\b", self.text, re.MULTILINE) is not None


def page_blocks(page: Path) -> list[Block]:
    """All blocks of a page, in order."""
    found = _FENCE.finditer(page.read_text(encoding="utf-8"))
    return [Block(each["language"], each["text"], _file(each["before"])) for each in found]


def run_page(page: Path, folder: Path, absent: frozenset[str] = frozenset()) -> None:
    """Write the files of a page to a folder and run its commands and programs there, in order.

    Blocks that need one of the ``absent`` packages are left out, and so are those that need their files.
    """
    lost: set[str] = set()
    for block in page_blocks(page):
        if any(block.needs(package) for package in absent) or any(name in block.text for name in lost):
            lost |= {block.file or "\0"} | set(re.findall(r"[\w-]+\.msh", block.text))
        elif block.file:
            (folder / block.file).parent.mkdir(parents=True, exist_ok=True)
            (folder / block.file).write_text(block.text + "\n", encoding="utf-8")
        elif block.language in RUN:
            _run(block, folder, page.name)


def is_missing(package: str) -> bool:
    """Whether a package is not installed, or lacks a library of the system."""
    if importlib.util.find_spec(package) is None:
        return True
    return subprocess.run([sys.executable, "-c", f"import {package}"], capture_output=True, check=False).returncode != 0


def _file(before: str) -> str | None:
    found = _FILE.search(before)
    return (found["saved"] or found["named"]) if found else None


def _run(block: Block, folder: Path, page: str) -> None:
    command = ["bash", "-e", "-c", block.text] if block.language == "sh" else [sys.executable, "-c", block.text]
    done = subprocess.run(command, cwd=folder, env=_environment(folder), capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{page}:\n{block.text}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"


def _environment(folder: Path) -> dict[str, str]:
    """The tests' Python and `rigidfluid` on the path, packages from ``folder``, and a pip that asks no server."""
    commands = folder.parent / "commands"
    if not commands.exists():
        commands.mkdir()
        _script(commands / "python", f'exec "{sys.executable}" "$@"')
        _script(commands / "pip", f'exec "{sys.executable}" -m pip "$@"')
        _script(commands / "rigidfluid", f'exec "{sys.executable}" -c "from rigidfluid.cli import app; app()" "$@"')
    installed = folder.parent / "installed"
    source = Path(rigidfluid.__file__).parents[1]
    paths = [str(installed), str(source), *filter(None, [os.environ.get("PYTHONPATH")])]
    return os.environ | {
        "PATH": os.pathsep.join([str(commands), os.environ["PATH"]]),
        "PYTHONPATH": os.pathsep.join(paths),
        "PIP_TARGET": str(installed),
        "PIP_NO_INDEX": "1",
        "PIP_NO_DEPS": "1",
        "PIP_NO_BUILD_ISOLATION": "0",
        "PYTHONWARNINGS": "error::DeprecationWarning:rigidfluid",
    }


def _script(path: Path, line: str) -> None:
    path.write_text(f"#!/bin/sh\n{line}\n", encoding="utf-8")
    path.chmod(0o755)
