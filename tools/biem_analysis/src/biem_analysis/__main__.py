"""Entry point of ``python3 -m biem_analysis``."""

import sys

from .command_line import main

sys.exit(main())
