"""Agreement with the exact motion by pytest: the checks of `multibody_xval.agreement`, and fixtures for users' tests."""
