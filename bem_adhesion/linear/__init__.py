"""Linear problems of one Newton step: conjugate gradients, preconditioners, contact stiffness."""
