"""``python -m reports``: the same as ``multibody-xval``, where the first word is no command as its ``report``."""

if __name__ == "__main__":
    import sys

    from reference_lcp.process import heed_interrupts, refuse_shadows

    heed_interrupts()
    refuse_shadows()
    from reports.cli.console_script import COMMANDS, main

    main(*([] if sys.argv[1:2] and sys.argv[1] in COMMANDS else ["report"]))
