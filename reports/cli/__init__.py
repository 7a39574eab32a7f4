"""Further commands of ``multibody-xval report``."""
