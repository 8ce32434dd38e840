"""Execute docs/howto/notebook.ipynb and store what its cells show.

``python docs/make_notebook.py`` needs what ``pip install 'rigidfluid[notebooks]'`` brings. A test fails if a cell has
been edited since.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from site_tools.notebook import NOTEBOOK, input_digest


def executed(folder: Path) -> nbformat.NotebookNode:
    """The notebook with what its cells show, run in a folder."""
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    NotebookClient(notebook, timeout=240, resources={"metadata": {"path": str(folder)}}).execute()
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)  # the times of day
    notebook.metadata["language_info"] = {"name": "python"}
    notebook.metadata["executed_input"] = input_digest(notebook)
    return notebook


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as work:
        nbformat.write(executed(Path(work)), NOTEBOOK)
