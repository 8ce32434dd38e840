"""Code of pages: which blocks are files, which are run, and which are left out."""

from __future__ import annotations

from pathlib import Path

import pytest
from page_code import is_missing, page_blocks, run_page

PAGE = """# A page

Save this as `draw.py`:

```python
import nowhere
nowhere.write("box.msh")
```

```sh
python draw.py
```

Save this as `box.toml`:

```toml
file = "box.msh"
```

```sh
cat box.toml
```

`kept/note.py`:

```python
print("kept")
```

```sh
python kept/note.py > out.txt
```

```console
apt-get install nowhere
```
"""


@pytest.fixture
def page(tmp_path: Path) -> Path:
    path = tmp_path / "page.md"
    path.write_text(PAGE)
    (tmp_path / "session").mkdir()
    return path


def test_blocks_are_files_where_the_line_before_says_so(page: Path) -> None:
    found = [(block.language, block.file) for block in page_blocks(page)]
    files = [("python", "draw.py"), ("sh", None), ("toml", "box.toml"), ("sh", None), ("python", "kept/note.py")]
    assert found == [*files, ("sh", None), ("console", None)]


def test_blocks_of_a_missing_package_and_of_its_files_are_left_out(page: Path, tmp_path: Path) -> None:
    run_page(page, tmp_path / "session", frozenset({"nowhere"}))
    assert {path.name for path in (tmp_path / "session").iterdir()} == {"kept", "out.txt"}
    assert (tmp_path / "session" / "out.txt").read_text() == "kept\n"


def test_a_command_that_fails_is_shown(page: Path, tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match=r"(?s)page.md:\npython draw.py.*No module named 'nowhere'"):
        run_page(page, tmp_path / "session")


def test_a_package_that_is_not_there_is_missing() -> None:
    assert is_missing("nowhere")
    assert not is_missing("json")
