"""Commands in this process, as the tests call them."""

from contact_study.command_line import program


def main(model, arguments):
    """Run a model, also one that is none of the three."""
    return program.main(model.command, arguments, model)
