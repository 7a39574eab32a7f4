"""From results to what people read: pages, figures and tables."""
