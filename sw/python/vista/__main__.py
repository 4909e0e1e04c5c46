"""`python -m vista`."""

import sys

from vista.cli import main

sys.exit(main())
