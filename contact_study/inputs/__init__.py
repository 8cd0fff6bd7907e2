"""Input from outside: units, files, plug-ins, and the error that names what cannot be used."""
