"""What several adapters share: coordinates, units, forces, shapes."""
