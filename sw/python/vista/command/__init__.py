"""The commands of the command line: each module has add_arguments, execute and its help as docstring."""
