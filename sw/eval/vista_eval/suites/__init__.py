"""The suites that are scored: paper's flights, sampled worlds, labelled scenes, pairs with measured truth."""
