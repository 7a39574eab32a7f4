"""A law of another engine, and one that cannot be made."""

from tests.wrong_engines.lawful.law import four_steps


def raises(_preset):
    raise ZeroDivisionError("1 / 0")


LAWS = {"joint:default": lambda preset: four_steps(preset, 0.26), "joint:tuned": raises}
