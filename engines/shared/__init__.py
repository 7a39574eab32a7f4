"""What several adapters share: wheel engines, the force loop, coordinates, units, boxes on plates, step costs."""
