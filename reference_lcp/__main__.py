"""``python -m reference_lcp``: the same as ``multibody-xval reference``."""

if __name__ == "__main__":
    from importlib import import_module

    from reference_lcp.process import heed_interrupts

    heed_interrupts()
    import_module("multibody_xval.reports.cli.console_script").main("reference")
