"""Launch files, configuration and the team runner."""
