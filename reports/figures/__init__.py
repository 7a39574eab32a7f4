"""The figures of the report, one module a subject; `reports.drawing` draws them, on the page and in print."""
