"""Pictures of runs and materials."""
