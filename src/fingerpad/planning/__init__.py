"""The planner: what a scene calls for, on which mesh, in which steps, why, and at what cost."""
