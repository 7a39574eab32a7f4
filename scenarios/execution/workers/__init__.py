"""Where tasks are computed: worker processes of this machine, workers of a cluster."""
