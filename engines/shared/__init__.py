"""What several adapters share: engines from pip, the force loop, coordinates, units, boxes on plates, step costs."""
