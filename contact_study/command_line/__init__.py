"""The commands: a file for each, arguments to messages and exit status; nothing is computed here."""
