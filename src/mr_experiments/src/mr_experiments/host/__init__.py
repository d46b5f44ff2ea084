"""A mission in virtual time: its robots with their engines, their radio, what is recorded."""
