"""Methods with which the product is compared."""
