"""The public names of the package, which are imported on first use."""

import ast
from pathlib import Path

import pytest

import reference_lcp


@pytest.mark.parametrize("name", reference_lcp.__all__)
def test_public_name_is_imported_from_its_folder(name: str) -> None:
    assert getattr(reference_lcp, name).__name__ == name


def test_type_checkers_see_every_public_name_where_it_is_imported_from() -> None:
    tree = ast.parse(Path(reference_lcp.__file__).read_text())
    imported = {
        alias.asname: (node.module, alias.name)
        for branch in tree.body
        if isinstance(branch, ast.If)
        for node in branch.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert imported == {name: (getattr(reference_lcp, name).__module__, name) for name in reference_lcp.__all__}


def test_name_that_is_not_public_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'chainn'"):
        reference_lcp.chainn  # noqa: B018
