"""Files of a report: page, figures, tables."""
