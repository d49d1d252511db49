"""The emulator of the pad, and its page to play with."""
