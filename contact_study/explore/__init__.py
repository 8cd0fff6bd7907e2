"""A page in the browser: results of all models, and studies to be set up and run; nothing is possible only here."""
