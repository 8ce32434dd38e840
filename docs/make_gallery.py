"""Write docs/gallery.md from the scenes, and docs/validation.md from the pages in docs/validation."""

from site_tools.gallery import DOCS, gallery
from site_tools.validation_index import validation_index

PAGES = {DOCS / "gallery.md": gallery, DOCS / "validation.md": validation_index}

if __name__ == "__main__":
    for path, text in PAGES.items():
        path.write_text(text(), encoding="utf-8")
