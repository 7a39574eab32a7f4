"""Where results are kept: the store, its file, and files that nobody needs once they are read."""
