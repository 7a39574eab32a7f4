"""Agreement with the exact motion by pytest: checks of `multibody_xval.agreement`, fixtures for users' tests."""
