"""One block on a carrier."""
