"""One page about judged points: tables, figures and templates, each a function of tables."""
