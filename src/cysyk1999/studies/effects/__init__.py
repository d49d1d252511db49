"""What each effect changes and costs, and what the planner makes of it."""
