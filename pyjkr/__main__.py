"""`python -m pyjkr`."""

import sys

from pyjkr.cli import main

sys.exit(main())
