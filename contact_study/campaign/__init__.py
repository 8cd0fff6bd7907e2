"""Cases over processes, steps to disk, resume, and the face of the commands."""
