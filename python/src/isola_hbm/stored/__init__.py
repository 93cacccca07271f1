"""Runs on disk: read from their store, ``run.sqlite``, without the program and without a bus."""
