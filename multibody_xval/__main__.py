"""``python -m multibody_xval``: the same as ``multibody-xval``."""

if __name__ == "__main__":
    from reference_lcp.process import heed_interrupts

    heed_interrupts()
    from multibody_xval.reports.cli.console_script import main

    main()
