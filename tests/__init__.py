"""Tests of the four packages; a package of its own, for a wheel of DART installs another one of this name."""
