"""Truth as data: benchmark problems of dry friction with their exact motion, for tests in any language."""

from multibody_xval.scenarios.truth.judge import Motion, judged, read_motion
from multibody_xval.scenarios.truth.problem import Problem, problem_named, problems

__all__ = ["Motion", "Problem", "judged", "problem_named", "problems", "read_motion"]
