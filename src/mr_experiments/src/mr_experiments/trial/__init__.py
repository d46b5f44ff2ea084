"""What a mission is asked to be: a trial, scenarios of trials, their worlds."""
