"""The distance field of a circle: error against run time."""

from page_tools import Page, Work

from pages._studies import kernel_study


def page(work: Work) -> Page:
    """The study's plot and runs."""
    return kernel_study(work, "distance_field", "Distance field of a circle")
