"""Boxes and joints, as users of an engine write them."""
