"""What a report shows: collected results, findings, provenance."""
