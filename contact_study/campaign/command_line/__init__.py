"""The command line of the models: arguments, messages, exit status, examples and a look at a surface."""
