"""`python -m palmbots` is the command `palmbots`."""

from palmbots.cli import main

if __name__ == "__main__":
    main()
