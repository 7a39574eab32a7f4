"""The public names of the package, which are imported on first use."""

import pytest

import reference_lcp


@pytest.mark.parametrize("name", reference_lcp.__all__)
def test_public_name_is_imported_from_its_folder(name: str) -> None:
    public = getattr(reference_lcp, name)
    assert (public.__module__, public.__name__) == (f"reference_lcp.{reference_lcp._MODULES[name]}", name)


def test_name_that_is_not_public_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'chainn'"):
        reference_lcp.chainn  # noqa: B018
