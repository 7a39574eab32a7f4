"""``python -m reference_lcp``: the same as ``multibody-xval reference``."""

if __name__ == "__main__":
    from importlib import import_module

    from reference_lcp.process import heed_interrupts, refuse_shadows

    heed_interrupts()
    refuse_shadows()
    import_module("reports.cli.console_script").main("reference")
