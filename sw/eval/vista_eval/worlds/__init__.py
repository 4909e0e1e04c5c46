"""The scenes of the flights."""
