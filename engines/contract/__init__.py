"""What every engine must do, whatever it is: a test suite that is installed with the engines.

``pytest --pyargs engines.contract --engine NAME`` holds one engine to it; without ``--engine``, all that are installed.
"""
