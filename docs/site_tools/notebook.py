"""The notebook of the how-to pages as a page of the site, with the outputs that are stored in it."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

NOTEBOOK = Path(__file__).parents[1] / "howto" / "notebook.ipynb"


def input_digest(notebook: dict[str, Any]) -> str:
    """SHA-256 of all code in a notebook, by which outputs of another code are told."""
    code = [_text(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    return hashlib.sha256("\0".join(code).encode()).hexdigest()


def page_text(text: str) -> str:
    """Markdown of the notebook in a file's ``text``: its words, its code, and what each cell shows."""
    parts = [part for cell in json.loads(text)["cells"] for part in _parts(cell)]
    return "\n\n".join([*parts, f"{{download}}`Download this notebook <{NOTEBOOK.name}>`."]) + "\n"


def _parts(cell: dict[str, Any]) -> list[str]:
    if cell["cell_type"] == "markdown":
        return [_text(cell["source"])]
    return [f"```python\n{_text(cell['source'])}\n```", *map(_shown, cell["outputs"])]


def _shown(output: dict[str, Any]) -> str:
    """Markdown of one output: its page, its picture, or else its text."""
    data = output.get("data") or {"text/plain": output.get("text", "")}
    if "text/html" in data:
        html = _text(data["text/html"])
    elif "image/png" in data:
        html = f'<img alt="figure of the cell above" src="data:image/png;base64,{_text(data["image/png"]).strip()}">'
    else:
        return f"```text\n{_text(data['text/plain'])}\n```"
    return f'```{{raw}} html\n<div class="notebook-output">\n{html}\n</div>\n```'


def _text(lines: str | list[str]) -> str:
    return lines if isinstance(lines, str) else "".join(lines)
