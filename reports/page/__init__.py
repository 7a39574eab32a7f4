"""The page: sections, one class and one template each."""
