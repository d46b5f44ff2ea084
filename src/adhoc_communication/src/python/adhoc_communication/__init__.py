"""The robot's radio: its messages and services, and how programs of this stack begin."""
