"""``python -m linkwork``: the command line without an installed script."""

from linkwork.cli.main import main

if __name__ == "__main__":
    main()
