"""Linear problems of one Newton step; the law is a curvature at each point."""
