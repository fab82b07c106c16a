"""``python -m regframe`` is the command line."""

from regframe.cli.main import main

if __name__ == "__main__":
    main()
