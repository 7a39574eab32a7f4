"""``python -m multibody_xval``: the same as ``multibody-xval``."""

from multibody_xval.reports.cli.entry_point import main

if __name__ == "__main__":
    main()
