"""Results for the documentation."""
