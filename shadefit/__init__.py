"""The application: the command line and what it prints."""
