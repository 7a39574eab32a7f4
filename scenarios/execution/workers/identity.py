"""What a variant is on one machine: results of another one are not taken for its."""

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reference_lcp.refusal import ParameterError
from scenarios.execution.computation.failures import text_of


def identity_of(variant: Variant) -> str:
    """Give versions of engine, Python and suite, and the options of the preset, as this process has them.

    Parameters
    ----------
    variant
        Its engine need not be there; then this is the reason.
    """
    try:
        own, preset = engine(variant.engine), variant.preset
    except ParameterError as problem:
        return text_of(problem)
    missing = own.unavailable_reason()
    if missing is not None:
        return f"{variant}, not installed: {missing}"
    options = ", ".join(f"{name} = {option.value!r}" for name, option in sorted(preset.options.items()))
    suite = engine("reference").version()
    return f"{variant} {own.version()} ({options}), Python {own.python()}, suite {suite}".replace(" ()", "")


def mismatch_reason(here: str, expected: str) -> str | None:
    """Give the reason why a worker may not run a batch: it is another variant than its client's; ``None`` if not."""
    return None if here == expected else f"not the same in the worker: {here}; expected: {expected}"
