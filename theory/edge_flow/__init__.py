"""Edge-flow theory: the gap flow with the elastic cost of contact edges. Unpublished."""
