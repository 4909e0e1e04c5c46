"""The commands of the extra [flights], one module each."""
