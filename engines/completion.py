"""Names that a shell completes: engines, and their formulations and presets once a colon is typed.

Every command line imports this module, and the registry only where something is completed.
"""


def complete_variant(incomplete: str) -> list[str]:
    """Give the names of variants that begin so; of engines alone before the first colon, which loads none of them."""
    engine, colon, _ = incomplete.partition(":")
    if not colon:
        return complete_engine(incomplete)
    from multibody_xval.engines.interface.variant import variants_of
    from reference_lcp.errors import ParameterError

    try:
        variants = variants_of(engine, optional=True, scenes_only=True)
    except ParameterError:
        return []
    names = [f"{each.engine}:{each.formulation}:{each.preset_name}" for each in variants]
    return [name for name in names if name.startswith(incomplete)]


def complete_engine(incomplete: str) -> list[str]:
    """Give the names of engines that begin so."""
    from multibody_xval.engines.interface.registry import registered_names

    return [name for name in registered_names() if name.startswith(incomplete)]
