"""The suites that are scored: paper's flights, sampled worlds, pairs with measured truth."""
