"""Scripts that show a number in an engine's own API, without the suite: for the engine's tracker."""
