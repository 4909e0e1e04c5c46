"""The scenes of the flights and of the labelled scenes."""
