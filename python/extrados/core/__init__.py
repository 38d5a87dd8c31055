"""The only importer of the compiled module: SI arrays in, statuses turned into exceptions."""
