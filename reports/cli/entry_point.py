"""The entry point of ``multibody-xval``: heeds Ctrl-C before it imports anything else."""

from reference_lcp.process import heed_interrupts


def main() -> None:
    """Run the command line and end with its exit code."""
    heed_interrupts()
    from multibody_xval.reports.cli.console_script import main as run

    run()
