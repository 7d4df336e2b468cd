"""``python -m moldloft``: the command, if its script is not on the path."""

import sys

from moldloft.cli import main

if __name__ == "__main__":
    sys.exit(main())
