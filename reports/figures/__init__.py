"""The figures of the report, one module a subject: each describes its figures once, and two backends draw them."""
