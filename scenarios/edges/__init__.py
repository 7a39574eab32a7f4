"""Edges of the attenuation band: found, refined by runs of each curve's own configuration, compared with the exact."""

from multibody_xval.scenarios.edges.finding import DEPTH_DB, EDGES, FEWEST_POINTS, THRESHOLD_DB, edges, refined
from multibody_xval.scenarios.edges.judging import judged_edges
from multibody_xval.scenarios.edges.proposing import propose

__all__ = ["DEPTH_DB", "EDGES", "FEWEST_POINTS", "THRESHOLD_DB", "edges", "judged_edges", "propose", "refined"]
