"""The contract between engines and the suite: engine, presets, registry, variant, tolerances."""
