"""Edge-flow theory, this project's own and unpublished: the gap flow with the elastic cost of contact edges."""
