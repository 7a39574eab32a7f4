"""What every engine must do, whatever it is: a test suite that is installed with the engines.

``pytest --pyargs multibody_xval.engines.contract --xval-engine NAME`` holds one engine to it; without the option, all
that are installed.
"""
