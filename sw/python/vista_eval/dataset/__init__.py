"""Flights and labelled scenes on disk: what is written of them and how it is read back, side by side."""
