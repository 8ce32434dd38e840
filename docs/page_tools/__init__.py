"""How the pages of docs/validation are made: kept runs and studies, the pages themselves, and which are out of date."""

from page_tools.kept_run import Run
from page_tools.page import Page, table
from page_tools.work import Work

__all__ = ["Page", "Run", "Work", "table"]
