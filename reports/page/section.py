"""What a section of a report is: one class and one template, from the suite or from another package."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from importlib.metadata import entry_points
from typing import Any, ClassVar

from multibody_xval.reports.data.report import Report
from multibody_xval.reports.figures.drawing import Drawing

SUITE_TEMPLATES = "multibody_xval.reports.page"
"""Package that holds the suite's own templates."""

ENTRY_POINT_GROUP = "multibody_xval.sections"
"""Group under which a distribution registers sections of its own: names of classes, or of anything that makes one."""


class Section(ABC):
    """One section of a page.

    A section of another package sets `templates` to that package, whose folder ``templates`` holds
    ``<template>.html``. Templates are of jinja2; ``{{ figure("name") }}`` sets one of the section's figures.
    """

    title: ClassVar[str]
    """The heading."""
    template: ClassVar[str]
    """Name of the template, without its ending; also the anchor of the section."""
    templates: ClassVar[str] = SUITE_TEMPLATES
    """Package that holds the template."""
    numbers: ClassVar[str] = ""
    """File beside the page that holds the numbers of the figures; none without."""

    def __init__(self, report: Report):
        self.report = report
        self.result = report.result

    @property
    def shown(self) -> bool:
        """Whether there is anything to show; a section without is left out."""
        return True

    def figures(self) -> list[Drawing]:
        """Figures of the section, in the order in which they stand; their names are unique in a report."""
        return []

    @abstractmethod
    def context(self) -> dict[str, Any]:
        """Variables of the template, beside its figures."""


def registered_sections() -> list[Callable[[Report], Section]]:
    """Give the sections that installed distributions register, by name."""
    entries = sorted(entry_points(group=ENTRY_POINT_GROUP), key=lambda entry: entry.name)
    return [entry.load() for entry in entries]
