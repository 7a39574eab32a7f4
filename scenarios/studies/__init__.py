"""Studies over many points: figure 3, its band and map, accuracy, work and precision."""
